// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * A track: cues in order of time, which do not overlap. Where there is no cue, all is silent. Times
 * are whole milliseconds of the film, levels whole percent, cells are row by row from the top left.
 *
 * @typedef {{start: number, end: number, levels: number[], frequency?: number, notes?: string[]}} Cue
 *   not to be changed; frequency: of its vibrations in Hz, none: the actuators' own
 * @typedef {{at: number, remove: number, insert: Cue[]}} Splice  at: an index when it is applied
 * @typedef {{from: number, to: number, cells?: number[]}} Selection  [from, to); no cells: all
 * @typedef {{cell: number, start: number, end: number, level: number, frequency?: number}} Span
 *   one cell at one level
 */

/** The longest track, as in lib/tracks: 100 h. */
export const LONGEST = 360_000_000;
/** As the desk takes them. */
export const MOST_NOTES = 16;

export const isSilent = (levels) => levels.every((level) => level === 0);

/** As people count: row and column from 1, or one number of up to 9 cells. */
export function cellName(cell, { cells, columns }) {
  return cells <= 9 ? `${cell + 1}` : `${Math.floor(cell / columns) + 1}.${cell % columns + 1}`;
}

/** The least and the largest of any number of values. */
export function extent(values) {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values) {
    least = Math.min(least, value);
    most = Math.max(most, value);
  }
  return [least, most];
}

const sameLevels = (a, b) => a === b || a.every((level, cell) => level === b[cell]);
const sameMap = (a, b) => sameLevels(a.levels, b.levels) && (a.frequency ?? 0) === (b.frequency ?? 0);
const sameNotes = (a = [], b = []) => a.length === b.length && a.every((note, i) => note === b[i]);
const same = (a, b) =>
  a === b || (a.start === b.start && a.end === b.end && sameMap(a, b) && sameNotes(a.notes, b.notes));

/** A number for a cue: equal for equal cues, hardly ever for others (32 bits, as in MurmurHash3). */
function numberOf({ start, end, levels, frequency = 0, notes = [] }, seed) {
  let hash = seed;
  const mix = (value) => {
    hash = Math.imul(hash ^ Math.imul(value, 0xcc9e2d51), 0x1b873593);
    hash = Math.imul(hash ^ (hash >>> 15), 5) + 0xe6546b64 | 0;
  };
  [start, end, ...levels, frequency].forEach(mix);
  for (const note of notes) {
    mix(note.length);
    for (let i = 0; i < note.length; i++) mix(note.charCodeAt(i));
  }
  hash = Math.imul(hash ^ (hash >>> 16), 0x85ebca6b);
  hash = Math.imul(hash ^ (hash >>> 13), 0xc2b2ae35);
  return (hash ^ (hash >>> 16)) >>> 0;
}

const SEEDS = [1, 0x9e3779b9];

export class Track {
  #cues;
  /** Sums of the cues' numbers, as their order follows from their times. */
  #sums = SEEDS.map(() => 0);

  /** Throws a RangeError if a cue is not valid, not in order or overlaps the one before. */
  constructor(rows, columns, cues = []) {
    this.rows = rows;
    this.columns = columns;
    this.cells = rows * columns;
    this.silence = Object.freeze(new Array(this.cells).fill(0));
    this.#cues = cues.slice();
    this.#check(0, this.#cues, this.#cues.length);
    this.#count([], this.#cues);
  }

  /** Equal for tracks with equal cues, hardly ever for others (64 bits). Costs nothing. */
  get fingerprint() {
    return this.#sums.map((sum) => sum.toString(16).padStart(8, '0')).join('');
  }

  #count(removed, inserted) {
    SEEDS.forEach((seed, i) => {
      for (const cue of removed) this.#sums[i] = this.#sums[i] - numberOf(cue, seed) >>> 0;
      for (const cue of inserted) this.#sums[i] = this.#sums[i] + numberOf(cue, seed) >>> 0;
    });
  }

  /** @returns {Cue[]} read only */
  get cues() {
    return this.#cues;
  }

  /** End of the last cue, 0 if there is none. */
  get end() {
    return this.#cues.at(-1)?.end ?? 0;
  }

  /** Index of the last cue that begins at `ms` or before, -1 if there is none. O(log n). */
  indexAt(ms) {
    let low = 0;
    let high = this.#cues.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.#cues[middle].start <= ms) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /** The cue that holds `ms`, or null. */
  cueAt(ms) {
    const cue = this.#cues[this.indexAt(ms)];
    return cue && ms < cue.end ? cue : null;
  }

  /** Indices [first, last) of the cues that overlap [from, to). */
  range(from, to) {
    let first = Math.max(this.indexAt(from), 0);
    if (first < this.#cues.length && this.#cues[first].end <= from) first++;
    return [first, Math.max(this.indexAt(to - 1) + 1, first)];
  }

  /** Levels at `ms`, not to be changed. */
  at(ms) {
    return this.cueAt(ms)?.levels ?? this.silence;
  }

  level(cell, ms) {
    return this.at(ms)[cell];
  }

  /**
   * Applies splices one after the other: all, or none and a RangeError.
   * @returns {{inverse: Splice[], from: number, to: number}} what undoes them, and the time outside
   *   of which no map has changed (from = to = 0: nowhere)
   */
  apply(splices) {
    const inverse = [];
    let from = Infinity;
    let to = 0;
    const spread = (cues) => {
      if (cues.length === 0) return;
      from = Math.min(from, cues[0].start);
      to = Math.max(to, cues.at(-1).end);
    };
    try {
      for (const { at, remove, insert } of splices) {
        this.#check(at, insert, at + remove);
        const removed = this.#replace(at, remove, insert);
        inverse.unshift({ at, remove: insert.length, insert: removed });
        spread(removed);
        spread(insert);
      }
    } catch (error) {
      for (const { at, remove, insert } of inverse) this.#replace(at, remove, insert);
      throw error;
    }
    return { inverse, from: Math.min(from, to), to };
  }

  #replace(at, remove, insert) {
    const removed = this.#cues.slice(at, at + remove);
    // The number of arguments is limited.
    if (insert.length < 10_000) this.#cues.splice(at, remove, ...insert);
    else this.#cues = this.#cues.slice(0, at).concat(insert, this.#cues.slice(at + remove));
    this.#count(removed, insert);
    return removed;
  }

  /** Throws if `cues` do not fit in between cue at - 1 and cue `next`. */
  #check(at, cues, next) {
    if (!(Number.isInteger(at) && at >= 0 && at <= next && next <= this.#cues.length)) {
      throw new RangeError(`expected cues ${at} to ${next} to be among ${this.#cues.length}`);
    }
    let before = at === 0 ? 0 : this.#cues[at - 1].end;
    for (const { start, end, levels } of cues) {
      if (!(Number.isInteger(start) && Number.isInteger(end) && start < end && end <= LONGEST)) {
        throw new RangeError(`expected whole ms up to ${LONGEST}, got a cue of ${start} to ${end}`);
      }
      if (start < before) {
        throw new RangeError(`the cue at ${start} ms begins before ${before} ms, where another ends`);
      }
      if (levels.length !== this.cells
        || !levels.every((level) => Number.isInteger(level) && level >= 0 && level <= 100)) {
        throw new RangeError(
          `the cue at ${start} ms: expected ${this.cells} levels of 0 to 100, got ${levels}`);
      }
      before = end;
    }
    if (cues.length > 0 && next < this.#cues.length && this.#cues[next].start < before) {
      throw new RangeError(`the cue that ends at ${before} ms overlaps the next one, which begins at `
        + `${this.#cues[next].start} ms`);
    }
  }

  /**
   * The event of a cell that holds `ms`: a stretch in which the level is above 0.
   * @returns {Span|null} with its strongest level
   */
  eventAt(cell, ms) {
    const index = this.indexAt(ms);
    const cue = this.#cues[index];
    if (!cue || ms >= cue.end || cue.levels[cell] === 0) return null;
    let first = index;
    while (first > 0 && this.#cues[first - 1].end === this.#cues[first].start
      && this.#cues[first - 1].levels[cell] > 0) first--;
    return this.#eventFrom(cell, first).event;
  }

  /** The event that begins with cue `first`, and the index of the first cue after it. */
  #eventFrom(cell, first) {
    const { start } = this.#cues[first];
    let { end } = this.#cues[first];
    let level = 0;
    let after = first;
    for (; after < this.#cues.length; after++) {
      const cue = this.#cues[after];
      if (cue.levels[cell] === 0 || (after > first && cue.start !== end)) break;
      level = Math.max(level, cue.levels[cell]);
      end = cue.end;
    }
    return { event: { cell, start, end, level }, after };
  }

  /** Events of a cell that overlap [from, to), whole, in order. */
  * events(cell, from, to) {
    let [index, last] = this.range(from, to);
    const begun = this.eventAt(cell, from);
    if (begun) {
      yield begun;
      index = this.indexAt(begun.end - 1) + 1;
    }
    while (index < last) {
      if (this.#cues[index].levels[cell] === 0) {
        index++;
        continue;
      }
      const { event, after } = this.#eventFrom(cell, index);
      yield event;
      index = after;
    }
  }

  /** The next begin or end of an event of the cell after `ms`, or the last one before; or null. */
  nextEdge(cell, ms, forward) {
    const on = (index) => (this.#cues[index]?.levels[cell] ?? 0) > 0;
    const joined = (index) => on(index - 1) && on(index)
      && this.#cues[index - 1].end === this.#cues[index].start;
    if (forward) {
      for (let i = Math.max(this.indexAt(ms), 0); i < this.#cues.length; i++) {
        if (!on(i)) continue;
        const { start, end } = this.#cues[i];
        if (start > ms && !joined(i)) return start;
        if (end > ms && !joined(i + 1)) return end;
      }
      return null;
    }
    for (let i = this.indexAt(ms - 1); i >= 0; i--) {
      if (!on(i)) continue;
      const { start, end } = this.#cues[i];
      if (end < ms && !joined(i + 1)) return end;
      if (start < ms && !joined(i)) return start;
    }
    return null;
  }

  /** What is felt in a selection, clipped to it; cell by cell, neighbors of one level joined. */
  spans({ from, to, cells = [...this.silence.keys()] }) {
    const [first, last] = this.range(from, to);
    const spans = [];
    for (const cell of cells) {
      let span = null;
      for (let i = first; i < last; i++) {
        const cue = this.#cues[i];
        const level = cue.levels[cell];
        if (level === 0) continue;
        const start = Math.max(cue.start, from);
        const end = Math.min(cue.end, to);
        if (span && span.end === start && span.level === level && span.frequency === (cue.frequency ?? 0)) span.end = end;
        else spans.push(span = { cell, start, end, level, frequency: cue.frequency ?? 0 });
      }
    }
    return spans;
  }
}

/**
 * The smallest splices that make `after` of `before`. As cues are in order and do not overlap, each
 * one that both have stays.
 */
export function difference(before, after, offset = 0) {
  const splices = [];
  let open = null;
  let i = 0;
  let k = 0;
  while (i < before.length || k < after.length) {
    const gone = before[i];
    const come = after[k];
    if (gone && come && same(gone, come)) {
      open = null;
      i++;
      k++;
      continue;
    }
    if (!open) splices.push(open = { at: offset + k, remove: 0, insert: [] });
    const removes = gone && (!come || gone.start <= come.start);
    const inserts = come && (!gone || come.start <= gone.start);
    if (removes) {
      open.remove++;
      i++;
    }
    if (inserts) {
      open.insert.push(come);
      k++;
    }
  }
  return splices;
}

/**
 * Makes cues of pieces. Pieces of one cue are joined if their levels are equal, others only where
 * one of them has changed.
 *
 * @param {{start: number, end: number, levels: number[], frequency: number, origin: ?Cue, changed: boolean}[]} pieces
 * @returns cues that still know their pieces' origins: {start, end, levels, frequency, origins, silenced}
 */
export function join(pieces) {
  const joined = [];
  let last = null;
  let lastChanged = false;
  const count = (origins) => origins.reduce((sum, { notes = [] }) => sum + notes.length, 0);
  for (const { start, end, levels, frequency, origin, changed } of pieces) {
    const isSame = last && last.end === start && sameMap(last, { levels, frequency });
    const fromOne = isSame && origin !== null && last.origins.at(-1) === origin;
    const origins = origin === null || fromOne ? [] : [origin];
    if (fromOne || (isSame && (lastChanged || changed)
      && count([...last.origins, ...origins]) <= MOST_NOTES)) {
      last.end = end;
      last.origins.push(...origins);
      last.silenced &&= changed;
    } else {
      last = { start, end, levels, frequency, origins, silenced: changed && isSilent(levels) };
      joined.push(last);
    }
    lastChanged = changed;
  }
  return joined;
}
