// SPDX-License-Identifier: LGPL-2.1-or-later

/**
 * What is held on the grid while the film goes on, as spans of cells. Knows no film: each call says
 * the position, in ms.
 */
export class Recorder {
  #held = new Map(); // of a cell: {start, level, by}
  #done = [];

  /** @param {function(object[])} commit gets the spans [{cell, start, end, level}] of a finished gesture */
  constructor(commit) {
    this.commit = commit;
  }

  /** Levels that are held now, by cell. */
  get held() { return this.#held; }

  /**
   * A cell begins, or goes on with another level. `by` names the finger, key or stick that holds it,
   * and leaves the cell that it held before.
   */
  press(cell, level, ms, by) {
    const before = this.#held.get(cell);
    if (before?.level === level)
      return;
    for (const [other, stroke] of [...this.#held]) {
      if (other === cell || stroke.by === by)
        this.#end(other, ms);
    }
    this.#held.set(cell, { start: ms, level, by });
  }

  /** What `by` holds ends. When nothing is held any more the gesture is committed. */
  release(by, ms) {
    for (const [cell, stroke] of [...this.#held]) {
      if (stroke.by === by)
        this.#end(cell, ms);
    }
    this.#commitIfDone();
  }

  /** The film leaps from `from` to `to`: all that is held ends there and begins here. */
  leap(from, to) {
    for (const [cell, { level, by }] of [...this.#held]) {
      this.#end(cell, from);
      this.#held.set(cell, { start: to, level, by });
    }
  }

  /** Everything ends, as when the film pauses. */
  stop(ms) {
    for (const cell of [...this.#held.keys()])
      this.#end(cell, ms);
    this.#commitIfDone();
  }

  #end(cell, ms) {
    const { start, level } = this.#held.get(cell);
    this.#held.delete(cell);
    if (ms > start)
      this.#done.push({ cell, start, end: ms, level });
  }

  #commitIfDone() {
    if (this.#held.size || !this.#done.length)
      return;
    const spans = this.#done;
    this.#done = [];
    this.commit(spans);
  }
}
