// SPDX-License-Identifier: LGPL-2.1-or-later
import { Hint, element } from './forms.js';

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

/** Something good that happened without being asked for, or what to do first. */
export const tell = (text) => stay('news', text);

/** What was thrown, in the color that it deserves. */
export const failed = (thrown) => (thrown instanceof Hint ? tell : fail)(thrown.message);

/** Edits that could not be sent, as a file; they are forgotten when that is dismissed. */
export function offerKept(sync, text) {
  const file = new Blob([JSON.stringify(sync.kept, null, 1)], { type: 'application/json' });
  const href = URL.createObjectURL(file);
  const item = fail(text);
  item.firstChild.append(' ', element('a', { href, download: 'edits-not-sent.json' }, 'Download them'));
  item.lastChild.addEventListener('click', () => {
    URL.revokeObjectURL(href);
    while (sync.kept.length)
      sync.forget(0);
  });
}

/** The file has changed. @param {function()} save saves over it */
export function offerSaveOver(name, save) {
  const item = fail(`Another program has changed ${name} since it was opened or saved here. Nothing was saved. `
    + 'If you save over it, what the file has now is kept beside it.');
  const over = element('button', { type: 'button', id: 'save-over' }, 'Save over it');
  over.addEventListener('click', () => {
    item.remove();
    save();
  });
  item.insertBefore(over, item.lastChild);
}
