// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Undo and redo without limit, by inverse splices.
 *
 * A `change` event tells of each edit: {splices, from, to, label, kind}. kind is 'do', 'undo', 'redo'
 * or 'reset'; maps have changed from `from` to `to` ms only.
 *
 * @import {Track, Splice} from './track.js'
 */
export class History extends EventTarget {
  #undone = [];
  #done = [];

  /** @param {Track} track */
  constructor(track) {
    super();
    this.track = track;
  }

  /**
   * Applies an edit; an empty one does nothing. Throws a RangeError, and changes nothing, if it is
   * not valid.
   * @param {Splice[]} splices
   * @param {{label?: string, gesture?: any}} what what is undone; edits with the same gesture, one
   *   after the other, are one step
   */
  do(splices, { label = 'Edit', gesture = null } = {}) {
    if (splices.length === 0) return;
    const { inverse, from, to } = this.track.apply(splices);
    const last = this.#done.at(-1);
    if (gesture && last?.gesture === gesture) last.splices.unshift(...inverse);
    else this.#done.push({ label, gesture, splices: inverse });
    this.#undone = [];
    this.#tell({ splices, from, to, label, kind: 'do' });
  }

  /** @returns {string|null} what was undone, null if there is nothing */
  undo() {
    return this.#step(this.#done, this.#undone, 'undo');
  }

  redo() {
    return this.#step(this.#undone, this.#done, 'redo');
  }

  get undoLabel() {
    return this.#done.at(-1)?.label ?? null;
  }

  get redoLabel() {
    return this.#undone.at(-1)?.label ?? null;
  }

  /** Steps, the newest last: {label, splices}. */
  get done() {
    return this.#done.map(({ label, splices }) => ({ label, splices }));
  }

  get undone() {
    return this.#undone.map(({ label, splices }) => ({ label, splices }));
  }

  /** Steps of an earlier page with the same track. */
  restore({ done, undone }) {
    this.#done = done;
    this.#undone = undone;
  }

  /** Another track: all steps are gone. */
  reset(track) {
    const to = Math.max(this.track.end, track.end);
    this.track = track;
    this.#done = [];
    this.#undone = [];
    this.#tell({ splices: [], from: 0, to, label: 'Load', kind: 'reset' });
  }

  #step(steps, others, kind) {
    const step = steps.pop();
    if (!step) return null;
    const { inverse, from, to } = this.track.apply(step.splices);
    others.push({ label: step.label, gesture: null, splices: inverse });
    this.#tell({ splices: step.splices, from, to, label: step.label, kind });
    return step.label;
  }

  #tell(detail) {
    this.dispatchEvent(new CustomEvent('change', { detail }));
  }
}
