// SPDX-License-Identifier: LGPL-2.1-or-later

const number = (name, label, unit, value, min, max, step) => ({ name, label, unit, value, min, max, step });
const one = (...option) => [number('value', ...option)];

/** The operations of `tactile-track edit` for a form; `draft`: only where there is a draft. */
export const OPERATIONS = [
  { name: 'prune-shorter', label: 'Silence short events', options: one('Shorter than', 's', 0.2, 0, 60, 0.05) },
  { name: 'prune-weaker', label: 'Silence weak events', options: one('Weaker than', '%', 20, 0, 100, 1) },
  { name: 'merge', label: 'Even out', options: one('Differences up to', '%', 10, 0, 100, 1),
    hint: 'A map becomes equal to the one before if they differ by no more.' },
  { name: 'limit', label: 'Limit durations', hint: 'Ends longer events, and keeps a rest after each.',
    options: [number('longest', 'Longest', 's', 2, 0.01, 3600, 0.1), number('rest', 'Rest', 's', 0.5, 0, 3600, 0.1)] },
  { name: 'shift', label: 'Shift in time', options: one('Later by', 's', 0.1, -3600, 3600, 0.01),
    hint: 'Negative is earlier.' },
  { name: 'scale', label: 'Scale levels', options: one('Factor', '', 0.8, 0, 100, 0.05) },
  { name: 'silence', label: 'Silence', options: [] },
  { name: 'quantize', label: 'Round levels', options: one('Steps', '', 4, 1, 100, 1) },
  { name: 'draft', label: 'Take the draft', options: [], draft: true },
  { name: 'draft-max', label: 'Take the stronger of track and draft', options: [], draft: true },
  { name: 'draft-replace', label: 'Take the draft wherever it is felt', options: [], draft: true },
];

/**
 * What POST operation expects.
 * @param {object} kind one of OPERATIONS
 * @param {object} values of its options by name
 * @param {{from: number, to: number, cells?: number[]}|null} selection null: the whole track
 */
export function request(kind, values, selection) {
  const body = { operation: kind.name, selection: selection ?? {} };
  if (kind.name === 'limit')
    body.value = [values.longest, values.rest];
  else if (kind.options.length)
    body.value = values.value;
  return body;
}
