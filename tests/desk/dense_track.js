// SPDX-License-Identifier: LGPL-2.1-or-later
/** A track as brute force has it: a level for each cell and ms. Each edit is a loop over all of them. */
import { equal } from './check.js';

export class DenseTrack {
  constructor(track, length) {
    this.rows = track.rows;
    this.columns = track.columns;
    this.length = length;
    this.levels = [];
    for (let cell = 0; cell < track.cells; cell++) {
      this.levels.push(new Uint8Array(length));
      for (const { start, end, levels } of track.cues) this.levels[cell].fill(levels[cell], start, end);
    }
  }

  clone() {
    const copy = Object.assign(Object.create(DenseTrack.prototype), this);
    copy.levels = this.levels.map((levels) => levels.slice());
    return copy;
  }

  /** The track says the same at each ms. */
  expectLike(track, what) {
    const theirs = new DenseTrack(track, this.length);
    this.levels.forEach((levels, cell) => {
      const ms = levels.findIndex((level, at) => level !== theirs.levels[cell][at]);
      if (ms >= 0) equal(theirs.levels[cell][ms], levels[ms], `${what}: cell ${cell} at ${ms} ms`);
    });
  }

  cells({ cells }) {
    return cells ?? this.levels.map((_, cell) => cell);
  }

  /** change(level, ms, cell) of each ms in a selection. */
  each({ from, to, cells }, change) {
    for (const cell of this.cells({ cells })) {
      for (let ms = from; ms < Math.min(to, this.length); ms++) {
        const level = Math.round(change(this.levels[cell][ms], ms, cell));
        this.levels[cell][ms] = Math.min(Math.max(level, 0), 100);
      }
    }
  }

  /** What is felt in a selection: [cell, ms, level]; optionally silenced. */
  take(selection, silence) {
    const taken = [];
    this.each(selection, (level, ms, cell) => {
      if (level > 0) taken.push([cell, ms, level]);
      return silence ? 0 : level;
    });
    return taken;
  }

  put(taken, target) {
    for (const [cell, ms, level] of taken) {
      const [to, at, until = at + 1] = target(cell, ms);
      if (to === null) continue;
      for (let i = at; i < until; i++) this.levels[to][i] = level;
    }
  }

  /** [first, end) of the event that holds ms. */
  event(cell, ms) {
    const levels = this.levels[cell];
    if (!(levels[ms] > 0)) return null;
    let [first, end] = [ms, ms];
    while (levels[first - 1] > 0) first--;
    while (levels[end] > 0) end++;
    return [first, end];
  }
}
