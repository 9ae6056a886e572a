// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Edits of a track. Each function returns the smallest splices that do it, in order, and changes
 * nothing itself: History.do() applies them.
 *
 * Cues are maps of all cells, while an edit concerns some: cues are cut where it begins and ends, and
 * equal neighbors are joined where it has changed something, nowhere else. A cue that becomes silent
 * goes away, unless it has notes or the track ends with it.
 *
 * @import {Track, Cue, Splice, Selection, Span} from './track.js'
 */
import { LONGEST, MOST_NOTES, difference, isSilent, join } from './track.js';

const bounded = (value, least, most) => Math.min(Math.max(value, least), most);
const wholeLevel = (level) => bounded(Math.round(level), 0, 100);
const cellsOf = (track, { cells }) => cells ?? [...track.silence.keys()];
const silent = (spans) => spans.map((span) => ({ ...span, level: 0, frequency: undefined }));

/** Spans in whole ms within the track's limits; throws if a cell is not in the grid. */
function checked(track, spans) {
  return spans.map(({ cell, start, end, level, frequency }) => {
    if (!(Number.isInteger(cell) && cell >= 0 && cell < track.cells)) {
      throw new RangeError(`expected a cell of 0 to ${track.cells - 1}, got ${cell}`);
    }
    if (![start, end, level].every(Number.isFinite)) {
      throw new RangeError(`expected times and a level, got ${start}, ${end} and ${level}`);
    }
    return { cell, start: bounded(Math.round(start), 0, LONGEST),
      end: bounded(Math.round(end), 0, LONGEST), level: wholeLevel(level), frequency };
  }).filter(({ start, end }) => start < end);
}

/** The cues from..to cut at `times`, with levels that `spans` set; see join(). */
function pieces(cues, times, spans, silence) {
  const indexOf = new Map(times.map((time, index) => [time, index]));
  const painted = new Map(); // cell → level from each time on, -1: as it is
  const tuned = new Int16Array(times.length).fill(-1); // frequency, -1: as it is
  for (const { cell, start, end, level, frequency = -1 } of spans) {
    if (frequency >= 0) tuned.fill(frequency, indexOf.get(start), indexOf.get(end));
    if (!painted.has(cell)) painted.set(cell, new Int8Array(times.length).fill(-1));
    painted.get(cell).fill(level, indexOf.get(start), indexOf.get(end));
  }
  const made = [];
  let index = 0;
  for (let i = 0; i + 1 < times.length; i++) {
    const [start, end] = [times[i], times[i + 1]];
    while (index < cues.length && cues[index].end <= start) index++;
    const origin = cues[index]?.start <= start ? cues[index] : null;
    const before = origin?.levels ?? silence;
    let levels = before;
    for (const [cell, level] of painted) {
      if (level[i] < 0 || level[i] === before[cell]) continue;
      if (levels === before) levels = before.slice();
      levels[cell] = level[i];
    }
    // What has no frequency takes that of others only beside them.
    const isAlone = levels.every((level, cell) => level === 0 || painted.get(cell)?.[i] > 0);
    const isTuned = tuned[i] > 0 || (tuned[i] === 0 && isAlone);
    const frequency = isSilent(levels) ? 0 : isTuned ? tuned[i] : (origin?.frequency ?? 0);
    const changed = levels !== before || (origin && !isSilent(levels) && frequency !== (origin.frequency ?? 0));
    if (changed || origin) made.push({ start, end, levels, frequency, origin, changed });
  }
  return made;
}

/** Gives each joined cue its notes: of a cue that was cut, the first part that is felt has them. */
function giveNotes(joined, carried) {
  const noted = new Map();
  for (const cue of joined) {
    for (const origin of cue.origins) {
      const has = noted.get(origin);
      if (origin.notes?.length && (!has || (isSilent(has.levels) && !isSilent(cue.levels)))) {
        noted.set(origin, cue);
      }
    }
  }
  for (const { cue: origin, to } of carried) {
    const target = joined.find(({ start, end }) => start <= to && to < end);
    const others = [...noted].filter(([, cue]) => cue === target);
    const count = others.reduce((sum, [{ notes }]) => sum + notes.length, origin.notes.length);
    if (target && count <= MOST_NOTES) noted.set(origin, target);
  }
  for (const cue of joined) cue.notes = [];
  for (const [{ notes }, cue] of noted) cue.notes.push(...notes);
}

/**
 * Each span sets its cell to its level; later ones win.
 * @param {Track} track
 * @param {Span[]} spans
 * @param {{cue: Cue, to: number}[]} carried cues whose notes go to the cue that holds `to` ms
 * @returns {Splice[]}
 */
export function paint(track, spans, carried = []) {
  spans = checked(track, spans);
  if (spans.length === 0) return [];
  let from = Infinity;
  let to = 0;
  for (const { start, end } of spans) {
    from = Math.min(from, start);
    to = Math.max(to, end);
  }
  // With the neighbors, which may become equal.
  let [first, last] = track.range(from, to);
  first = Math.max(first - 1, 0);
  last = Math.min(last + 1, track.cues.length);
  const before = track.cues.slice(first, last);
  const times = new Set();
  for (const { start, end } of [...before, ...spans]) times.add(start).add(end);
  const joined = join(pieces(before, [...times].sort((a, b) => a - b), spans, track.silence));
  giveNotes(joined, carried);
  const isKept = ({ end, silenced, notes }, i) => !silenced || notes.length > 0
    || (i === joined.length - 1 && end >= track.end);
  const after = joined.filter(isKept).map(({ start, end, levels, frequency, notes }) =>
    ({ start, end, levels, ...frequency > 0 && { frequency }, ...notes.length > 0 && { notes } }));
  return difference(before, after, first);
}

/** Sets the level of a whole selection, 0 to 100. */
export function draw(track, selection, level) {
  const { from, to } = selection;
  return paint(track, cellsOf(track, selection).map((cell) => ({ cell, start: from, end: to, level })));
}

/** Silences a selection. */
export function erase(track, selection) {
  return draw(track, selection, 0);
}

/** Sets the level, 1 to 100, of what is felt in a selection. */
export function setLevel(track, selection, level) {
  level = bounded(level, 1, 100);
  return paint(track, track.spans(selection).map((span) => ({ ...span, level })));
}

/** Adds to the levels of what is felt, and keeps them in 1 to 100. */
export function addLevel(track, selection, by) {
  return paint(track, track.spans(selection)
    .map((span) => ({ ...span, level: bounded(span.level + by, 1, 100) })));
}

/**
 * Multiplies what is felt by a factor that goes from `first` to `last` percent over the selection, in
 * steps of `step` ms; each has the factor of its middle. What is felt stays so, unless a factor is 0.
 */
export function fade(track, selection, first, last, step = 50) {
  const { from, to } = selection;
  const steps = Math.max(Math.round((to - from) / Math.max(step, 1)), 1);
  const timeOf = (index) => from + Math.round((to - from) * index / steps);
  const spans = [];
  for (const { cell, start, end, level } of track.spans(selection)) {
    for (let i = Math.floor((start - from) * steps / (to - from)); i < steps; i++) {
      if (timeOf(i) >= end) break;
      if (timeOf(i + 1) <= start) continue;
      const factor = (first + (last - first) * (i + 0.5) / steps) / 100;
      spans.push({ cell, start: Math.max(start, timeOf(i)), end: Math.min(end, timeOf(i + 1)),
        level: factor > 0 ? bounded(level * factor, 1, 100) : 0 });
    }
  }
  return paint(track, spans);
}

/**
 * What move() will do: less than asked where something felt would begin before 0 or leave the grid.
 * @param {{ms?: number, rows?: number, columns?: number}} by
 */
export function clampedMove(track, selection, { ms = 0, rows = 0, columns = 0 }) {
  const spans = track.spans(selection);
  if (spans.length === 0) return { ms: 0, rows: 0, columns: 0 };
  const ends = (value) => spans.reduce(([least, most], span) =>
    [Math.min(least, value(span)), Math.max(most, value(span))], [Infinity, -Infinity]);
  const [start] = ends((span) => span.start);
  const [, end] = ends((span) => span.end);
  const [top, bottom] = ends((span) => Math.floor(span.cell / track.columns));
  const [left, right] = ends((span) => span.cell % track.columns);
  return { ms: bounded(Math.round(ms), -start, LONGEST - end),
    rows: bounded(rows, -top, track.rows - 1 - bottom),
    columns: bounded(columns, -left, track.columns - 1 - right) };
}

/** The cues of which a selection holds all that is felt: their notes go along. */
function whole(track, { from, to, cells }) {
  const [first, last] = track.range(from, to);
  const chosen = cells && new Set(cells);
  return track.cues.slice(first, last).filter(({ start, end, levels, notes }) =>
    notes?.length > 0 && start >= from && end <= to && !isSilent(levels)
    && (!chosen || levels.every((level, cell) => level === 0 || chosen.has(cell))));
}

/** Moves what is felt in a selection over what is there, as far as clampedMove(). */
export function move(track, selection, by) {
  const { ms, rows, columns } = clampedMove(track, selection, by);
  if (ms === 0 && rows === 0 && columns === 0) return [];
  const spans = track.spans(selection);
  const moved = spans.map(({ cell, start, end, ...rest }) =>
    ({ cell: cell + rows * track.columns + columns, start: start + ms, end: end + ms, ...rest }));
  return paint(track, [...silent(spans), ...moved],
    whole(track, selection).map((cue) => ({ cue, to: cue.start + ms })));
}

/** Where a selection is after move(). */
export function movedSelection(track, selection, by) {
  const { ms, rows, columns } = clampedMove(track, selection, by);
  const moved = { from: Math.max(selection.from + ms, 0), to: selection.to + ms };
  if (selection.cells) {
    moved.cells = selection.cells
      .map((cell) => [Math.floor(cell / track.columns) + rows, cell % track.columns + columns])
      .filter(([row, column]) => row >= 0 && row < track.rows && column >= 0 && column < track.columns)
      .map(([row, column]) => row * track.columns + column);
  }
  return moved;
}

/** Lets what is felt in a selection last from `from` to `to` instead. */
export function stretch(track, selection, { from, to }) {
  if (!(from >= 0 && from < to)) throw new RangeError(`expected a time to be felt, got ${from} to ${to}`);
  const factor = (to - from) / (selection.to - selection.from);
  const scaled = (ms) => Math.round(from + (ms - selection.from) * factor);
  const spans = track.spans(selection);
  const stretched = spans.map(({ cell, start, end, ...rest }) =>
    ({ cell, start: scaled(start), end: Math.max(scaled(end), scaled(start) + 1), ...rest }));
  return paint(track, [...silent(spans), ...stretched],
    whole(track, selection).map((cue) => ({ cue, to: scaled(cue.start) })));
}

/**
 * Makes two events of each that holds `at` ms: `rest` ms after it are silent. Where less than that is
 * left, the event stays as it is.
 */
export function split(track, selection, at, rest = 100) {
  const spans = [];
  for (const cell of cellsOf(track, selection)) {
    const event = track.eventAt(cell, at);
    if (event && event.start < at && at + rest < event.end) {
      spans.push({ cell, start: at, end: at + rest, level: 0 });
    }
  }
  return paint(track, spans);
}

/** Fills the silences in between a cell's events in a selection with the level before. */
export function merge(track, selection) {
  const spans = track.spans(selection);
  return paint(track, spans.flatMap((span, i) => {
    const next = spans[i + 1];
    return next && next.cell === span.cell && next.start > span.end
      ? [{ cell: span.cell, start: span.end, end: next.start, level: span.level }] : [];
  }));
}

/**
 * What is felt in a selection, for paste(); it can be made JSON.
 * @returns {{rows: number, columns: number, duration: number, spans: object[]}}
 */
export function copy(track, selection) {
  const cells = cellsOf(track, selection);
  const rowOf = (cell) => Math.floor(cell / track.columns);
  const columnOf = (cell) => cell % track.columns;
  const top = Math.min(...cells.map(rowOf));
  const left = Math.min(...cells.map(columnOf));
  return {
    rows: Math.max(...cells.map(rowOf)) - top + 1,
    columns: Math.max(...cells.map(columnOf)) - left + 1,
    duration: selection.to - selection.from,
    spans: track.spans(selection).map(({ cell, start, end, ...rest }) => ({ row: rowOf(cell) - top,
      column: columnOf(cell) - left, start: start - selection.from, end: end - selection.from, ...rest })),
  };
}

/** Puts a copy over what is there, its top left cell at `cell`. What is beyond the grid is left out. */
export function paste(track, clip, { at, cell = 0 }) {
  const top = Math.floor(cell / track.columns);
  const left = cell % track.columns;
  return paint(track, clip.spans
    .filter(({ row, column }) => row + top < track.rows && column + left < track.columns)
    .map(({ row, column, start, end, ...rest }) => ({ cell: (row + top) * track.columns + column + left,
      start: start + at, end: end + at, ...rest })));
}

/** Replaces the notes of the cue at an index. Throws a RangeError if one is not valid in WebVTT. */
export function setNotes(track, index, notes) {
  const before = track.cues[index];
  if (!before) throw new RangeError(`expected a cue of 0 to ${track.cues.length - 1}, got ${index}`);
  if (notes.length > MOST_NOTES) throw new RangeError(`expected ${MOST_NOTES} notes at most`);
  for (const note of notes) {
    const bytes = new TextEncoder().encode(note).length;
    if (bytes === 0 || bytes > 4096) throw new RangeError(`a note has 1 to 4096 bytes, got ${bytes}`);
    if (note.includes('-->')) throw new RangeError('a note cannot have "-->"');
    if (/^\s*$/m.test(note)) throw new RangeError('a note cannot have empty lines');
  }
  const { notes: _, ...cue } = before;
  if (notes.length > 0) cue.notes = notes;
  return difference([before], [cue], index);
}
