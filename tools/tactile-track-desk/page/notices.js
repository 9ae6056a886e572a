// SPDX-License-Identifier: LGPL-2.1-or-later
import { element } from './forms.js';

/** For screen readers, and for tests: the last thing that happened. */
export function say(text) { document.getElementById('live').textContent = text; }

/** A line that stays until it is dismissed; the same one is there once. Returns its item. */
function stay(list, text) {
  const items = document.getElementById(list);
  [...items.children].find((item) => item.firstChild.textContent === text)?.remove();
  const close = element('button', { type: 'button' }, 'Dismiss');
  const item = element('li', {}, element('span', {}, text), close);
  close.addEventListener('click', () => item.remove());
  items.append(item);
  return item;
}

/** An error. */
export const fail = (text) => stay('alerts', text);
export const failed = (thrown) => fail(thrown.message);

/** Something good that happened without being asked for. */
export const tell = (text) => stay('news', text);
