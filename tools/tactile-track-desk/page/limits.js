// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Where a track breaks the limits that spare motors and skin (lib/tactor/motor_limits.h). A chair
 * ends or leaves out what is beyond them, so that the film is felt differently there.
 *
 * - `time`: a cell is felt for longer than maxOnTime. A break below shortestRest is none.
 * - `duty`: it is felt for more than maxDuty of the dutyWindow that ends here.
 * - `active`: more than maxActive cells are felt at once.
 *
 * Each is a statement about a moment that only what is before it decides, so that an edit concerns
 * the time from its begin on until windows and events that hold it are over.
 *
 * @import {Track} from './track.js'
 * @typedef {{maxOnTime: number, maxDuty: number, dutyWindow: number, maxActive: number,
 *   shortestRest: number}} MotorLimits  ms; 0 is off, as is a duty of 1 and above
 * @typedef {{kind: 'time'|'duty'|'active', cell: number, start: number, end: number, text: string}}
 *   Warning  cell: -1 for 'active'
 */
import { cellName } from './track.js';

const seconds = (ms) => `${(ms / 1000).toLocaleString('en', { maximumFractionDigits: 2 })} s`;

/** The part of [start, end) in [from, to), if there is one. */
function* clipped(warning, from, to) {
  const start = Math.max(warning.start, from);
  const end = Math.min(warning.end, to);
  if (start < end) yield { ...warning, start, end };
}

export class Limits {
  /**
   * @param {Track} track
   * @param {MotorLimits} limits
   */
  constructor(track, limits) {
    this.limits = limits;
    this.reset(track);
  }

  reset(track) {
    this.track = track;
    this.#found = [...this.#between(0, Infinity)];
    this.#sort();
  }

  /** After maps have changed from `from` to `to` ms: looks again where that may have broken a limit. */
  update(from, to) {
    if (from >= to) return;
    const until = this.#concerned(to);
    const outside = this.#found.flatMap((warning) =>
      [...clipped(warning, 0, from), ...clipped(warning, until, Infinity)]);
    this.#found = [...outside, ...this.#between(from, until)];
    this.#sort();
  }

  #found;

  /** A break that is one. */
  get #rest() {
    return Math.max(this.limits.shortestRest, 1);
  }

  /** Sorts, and joins what was cut. */
  #sort() {
    const last = new Map();
    this.warnings = [];
    for (const warning of this.#found.sort((a, b) => a.start - b.start || a.cell - b.cell)) {
      const { kind, cell, start, end } = warning;
      const before = last.get(this.#text(kind, cell));
      if (before?.end === start) {
        before.end = end;
        continue;
      }
      const copy = { kind, cell, start, end, text: this.#text(kind, cell) };
      last.set(copy.text, copy);
      this.warnings.push(copy);
    }
    this.#found = this.warnings;
  }

  #texts = {};

  #text(kind, cell) {
    const texts = this.#texts[kind] ??= [];
    return texts[cell + 1] ??= this.#makeText(kind, cell);
  }

  #makeText(kind, cell) {
    const { maxOnTime, maxDuty, dutyWindow, maxActive } = this.limits;
    const name = cellName(cell, this.track);
    switch (kind) {
      case 'time': return `Cell ${name} is felt for more than ${seconds(maxOnTime)} without a break`;
      case 'duty':
        return `Cell ${name} is felt for more than ${Math.round(maxDuty * 100)} % of ${seconds(dutyWindow)}`;
      default: return `More than ${maxActive} cells are felt at once`;
    }
  }

  /** Until when a change that ends at `to` may matter. */
  #concerned(to) {
    const { maxDuty, dutyWindow } = this.limits;
    let until = maxDuty > 0 && maxDuty < 1 ? to + dutyWindow : to;
    for (let cell = 0; cell < this.track.cells; cell++) {
      until = Math.max(until, this.#cueEnd(cell, to));
    }
    return until;
  }

  /** End of the stretches from `to` on in between which there is no rest. */
  #cueEnd(cell, to) {
    let end = to;
    const { cues } = this.track;
    for (let i = Math.max(this.track.indexAt(to), 0); i < cues.length; i++) {
      if (cues[i].start - end >= this.#rest) break;
      if (cues[i].levels[cell] > 0) end = Math.max(cues[i].end, end);
    }
    return end;
  }

  /** Begin of the stretches before `from` in between which there is no rest. */
  #cueBegin(cell, from) {
    let begin = from;
    const { cues } = this.track;
    for (let i = this.track.indexAt(from); i >= 0; i--) {
      if (begin - cues[i].end >= this.#rest) break;
      if (cues[i].levels[cell] > 0) begin = Math.min(cues[i].start, begin);
    }
    return begin;
  }

  * #between(from, to) {
    const { maxOnTime, maxDuty, maxActive } = this.limits;
    const last = Math.min(to, this.track.end);
    for (let cell = 0; cell < this.track.cells; cell++) {
      if (maxOnTime > 0) yield* this.#tooLong(cell, from, last);
      if (maxDuty > 0 && maxDuty < 1) yield* this.#tooMuch(cell, from, last);
    }
    if (maxActive > 0) yield* this.#tooMany(from, last);
  }

  * #tooLong(cell, from, to) {
    let cue = { begin: -Infinity, end: -Infinity };
    for (const { start, end } of this.#stretches(cell, this.#cueBegin(cell, from), to)) {
      if (start - cue.end >= this.#rest) cue = { begin: start, end };
      cue.end = end;
      yield* clipped({ kind: 'time', cell, start: Math.max(start, cue.begin + this.limits.maxOnTime), end },
        from, to);
    }
  }

  * #tooMuch(cell, from, to) {
    const { maxDuty, dutyWindow } = this.limits;
    const stretches = [...this.#stretches(cell, from - dutyWindow, to)];
    let oldest = 0; // whose end is in the window
    let left = Math.round(maxDuty * dutyWindow); // of what may be felt, without what has left whole
    for (const { start, end } of stretches) {
      // While nothing leaves the window, what is left falls as fast as time goes on, else it stays.
      // So once it is used up, it stays so until the stretch ends.
      let at = start;
      let over = Infinity;
      while (at < end && over === Infinity) {
        while (stretches[oldest].end + dutyWindow <= at) {
          left += stretches[oldest].end - stretches[oldest].start;
          oldest++;
        }
        const leaves = stretches[oldest].start + dutyWindow;
        const now = left - (at - start) + Math.max(at - leaves, 0);
        const next = Math.min(end, at < leaves ? leaves : stretches[oldest].end + dutyWindow);
        if (now < 0) over = at;
        else if (at < leaves && at + now < next) over = at + now;
        at = next;
      }
      if (over < end) yield* clipped({ kind: 'duty', cell, start: over, end }, from, to);
      left -= end - start;
    }
  }

  * #tooMany(from, to) {
    const [first, last] = this.track.range(from, to);
    for (const { start, end, levels } of this.track.cues.slice(first, last)) {
      let active = 0;
      for (const level of levels) if (level > 0) active++;
      if (active > this.limits.maxActive) {
        yield* clipped({ kind: 'active', cell: -1, start, end }, from, to);
      }
    }
  }

  /** Where a cell is felt in [from, to), clipped to it. */
  * #stretches(cell, from, to) {
    const [first, last] = this.track.range(Math.max(from, 0), to);
    const { cues } = this.track;
    let stretch = null;
    for (let i = first; i < last; i++) {
      if (cues[i].levels[cell] === 0) continue;
      if (stretch?.end === cues[i].start) {
        stretch.end = Math.min(cues[i].end, to);
        continue;
      }
      if (stretch) yield stretch;
      stretch = { start: Math.max(cues[i].start, from), end: Math.min(cues[i].end, to) };
    }
    if (stretch) yield stretch;
  }
}
