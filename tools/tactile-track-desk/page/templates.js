// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Templates: vibrations to begin with. Each fills a selection, also with the silences in it.
 *
 * @import {Track, Selection, Span} from './track.js'
 */

const number = (name, label, unit, value, min, max, step) => ({ name, label, unit, value, min, max, step });
const level = number('level', 'Level', '%', 75, 1, 100, 5);

/** What a form asks for. An option has a range, or choices: [value, label]. */
export const TEMPLATES = [
  { name: 'pulse', label: 'Pulse', options: [level, number('on', 'On', 'ms', 200, 20, 10_000, 10),
    number('off', 'Off', 'ms', 300, 20, 10_000, 10)] },
  { name: 'ramp', label: 'Ramp', options: [number('first', 'From', '%', 10, 0, 100, 5),
    number('last', 'To', '%', 100, 0, 100, 5), number('step', 'Step', 'ms', 50, 10, 1000, 10)] },
  { name: 'sweep', label: 'Sweep', options: [level,
    number('overlap', 'Overlap of neighbors', '%', 25, 0, 90, 5),
    { name: 'direction', label: 'Direction', value: 'right', choices: [['right', 'To the right'],
      ['left', 'To the left'], ['down', 'Down'], ['up', 'Up'], ['cells', 'Cell by cell']] }] },
  { name: 'heartbeat', label: 'Heartbeat', options: [level,
    number('rate', 'Rate', 'beats a minute', 70, 30, 200, 5)] },
];

const fillers = {
  /** On and off, from the begin on. */
  pulse({ from, to }, { level, on, off }) {
    return every(from, to, on + off, (start) => [{ start, end: start + on, level }]);
  },

  /** A level that rises or falls in steps, the last one at the end. */
  ramp({ from, to }, { first, last, step }) {
    const steps = Math.max(Math.round((to - from) / step), 1);
    return Array.from({ length: steps }, (_, i) => ({ start: from + (to - from) * i / steps,
      end: from + (to - from) * (i + 1) / steps,
      level: steps > 1 ? first + (last - first) * i / (steps - 1) : last }));
  },

  /** Two beats, as the heart's two sounds: the second, weaker, 3/10 of a second after the first. At
   * high rates all is closer together. */
  heartbeat({ from, to }, { level, rate }) {
    const beat = 60_000 / rate;
    const apart = Math.min(300, 0.4 * beat);
    return every(from, to, beat, (start) => [{ start, end: start + 0.4 * apart, level },
      { start: start + apart, end: start + 1.3 * apart, level: 0.7 * level }]);
  },
};

function every(from, to, period, made) {
  const spans = [];
  for (let i = 0; from + i * period < to; i++) spans.push(...made(from + i * period));
  return spans;
}

/** Cells in groups that are felt at once, in order. */
function wave(track, cells, direction) {
  if (direction === 'cells') return cells.map((cell) => [cell]);
  const place = direction === 'right' || direction === 'left' ? (cell) => cell % track.columns
    : (cell) => Math.floor(cell / track.columns);
  const places = [...new Set(cells.map(place))].sort((a, b) => a - b);
  if (direction === 'left' || direction === 'up') places.reverse();
  return places.map((at) => cells.filter((cell) => place(cell) === at));
}

/** One after the other, each for so long that neighbors overlap by a share of that. */
function sweep(track, { from, to, cells }, { level, overlap, direction }) {
  const groups = wave(track, cells, direction);
  const share = overlap / 100;
  const length = (to - from) / (groups.length - (groups.length - 1) * share);
  return groups.flatMap((group, i) => {
    const start = from + i * length * (1 - share);
    return group.map((cell) => ({ cell, start, end: start + length, level }));
  });
}

/**
 * @param {string} name one of TEMPLATES
 * @param {Track} track
 * @param {Selection} selection what it fills
 * @param {object} options those of TEMPLATES; what is left out is as there
 * @returns {Span[]} for paint()
 */
export function template(name, track, selection, options = {}) {
  const known = TEMPLATES.find((one) => one.name === name);
  if (!known) {
    throw new RangeError(`expected one of ${TEMPLATES.map((one) => one.name)}, got ${name}`);
  }
  const values = {};
  for (const { name: option, value, min, max, choices } of known.options) {
    const given = options[option] ?? value;
    if (choices ? !choices.some(([choice]) => choice === given) : !(given >= min && given <= max)) {
      throw new RangeError(`${option}: expected ${choices ? choices.map(([choice]) => choice)
        : `${min} to ${max}`}, got ${given}`);
    }
    values[option] = given;
  }
  const { from, to, cells = [...track.silence.keys()] } = selection;
  const spans = name === 'sweep' ? sweep(track, { from, to, cells }, values)
    : cells.flatMap((cell) => fillers[name]({ from, to }, values).map((span) => ({ cell, ...span })));
  return [...cells.map((cell) => ({ cell, start: from, end: to, level: 0 })),
    ...spans.map((span) => ({ ...span, end: Math.min(span.end, to) }))];
}
