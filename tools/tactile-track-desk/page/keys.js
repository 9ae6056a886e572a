// SPDX-License-Identifier: LGPL-2.1-or-later
import { element } from './forms.js';
import { POINT_KEYS } from './point_keys.js';
import { KEYS as TIMELINE_KEYS } from './timeline.js';

/** Keys that work everywhere but in fields, for the help. */
export const KEYS = [
  { keys: ['Space', 'K'], does: 'Play, pause' },
  { keys: [',', '.'], does: 'One frame back, forward' },
  { keys: ['[', ']'], does: 'Slower, faster' },
  { keys: ['1–9', 'number block'], does: 'Paint on a cell while recording, else feel it' },
  { keys: ['R'], does: 'Record' },
  { keys: ['A'], does: 'Sound off, on' },
  { keys: ['G'], does: 'Map over the film' },
  { keys: ['E'], does: 'Full screen, with the grid over the film' },
  { keys: ['V'], does: 'Review' },
  { keys: ['J', 'Escape in a field'], does: 'To the timeline' },
  { keys: ['T'], does: 'To the time, which can be typed' },
  { keys: ['P'], does: 'To the selection’s fields' },
  { keys: ['Ctrl+Z'], does: 'Undo' },
  { keys: ['Ctrl+Shift+Z', 'Ctrl+Y'], does: 'Redo' },
  { keys: ['Ctrl+S'], does: 'Save' },
  { keys: ['?', 'F1'], does: 'This help' },
];

const PAD_KEYS = [
  { keys: ['Left stick'], does: 'Chooses the cell by its place' },
  { keys: ['Right trigger'], does: 'Paints, the stronger the farther it is pressed' },
  { keys: ['Lower face button'], does: 'Paints at the set level' },
];

/**
 * The command of a key press, or null.
 * @param {KeyboardEvent} event
 * @param {boolean} single single keys are on
 * @returns {{command: string, by?: number}|null}
 */
export function commandOf(event, single) {
  const { target } = event;
  const typing = target.matches('input:not([type=checkbox], [type=range]), textarea, select');
  const key = event.key.toLowerCase();
  if (event.ctrlKey || event.metaKey) {
    if (key === 's')
      return { command: 'save' };
    if (typing)
      return null;
    if (key === 'z')
      return { command: event.shiftKey ? 'redo' : 'undo' };
    return key === 'y' ? { command: 'redo' } : null;
  }
  if (key === 'f1')
    return { command: 'help' };
  if (typing && key === 'escape')
    return { command: 'timeline' };
  if (event.altKey || typing || !single)
    return null;
  if (/^(Digit|Numpad)[1-9]$/.test(event.code) && !event.shiftKey)
    return { command: 'cell' };
  if (key === ' ')
    return target.matches('button, summary, a, input') ? null : { command: 'play' };
  const commands = {
    k: ['play'], ',': ['step', -1], '.': ['step', 1], '[': ['rate', -1], ']': ['rate', 1], r: ['record'], a: ['mute'],
    g: ['map'], e: ['full'], v: ['review'], j: ['timeline'], p: ['panel'], t: ['time'], '?': ['help'],
  };
  const [command, by] = commands[key] ?? [];
  return command ? { command, by } : null;
}

/** @param {HTMLInputElement} box that switches single keys on and off; the browser remembers it */
export function rememberSingleKeys(box) {
  try {
    box.checked = localStorage.getItem('single-keys') !== 'off';
  } catch {
    // Without storage they are on.
  }
  box.addEventListener('change', () => localStorage.setItem('single-keys', box.checked ? 'on' : 'off'));
}

function table(caption, keys) {
  const rows = keys.map(({ keys, does }) => element('tr', {},
    element('th', { scope: 'row' }, ...keys.flatMap((key, i) => (i ? [' or ', element('kbd', {}, key)] : [element('kbd', {}, key)]))),
    element('td', {}, does)));
  return element('table', {}, element('caption', {}, caption), ...rows);
}

/** All keys, as tables. */
export function keyTables() {
  return [table('Everywhere', KEYS), table('In the timeline', TIMELINE_KEYS),
    table('In the timeline, with the tool Curve', POINT_KEYS), table('On a gamepad', PAD_KEYS)];
}
