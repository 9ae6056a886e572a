// SPDX-License-Identifier: LGPL-2.1-or-later

/** The newest steps are kept up to this many characters. */
const MOST = 1 << 20;

/**
 * Keeps the steps of undo and redo in the browser's storage, so that a page that is loaded again has them:
 * with the fingerprint of the track that they are for, as they fit no other one.
 */
export class UndoStore {
  #history;
  #key;
  #storage;
  #unkept = false;

  /**
   * @param {import('./history.js').History} history
   * @param {string} name of the track
   * @param {Storage} [storage]
   */
  constructor(history, name, storage = localStorage) {
    this.#history = history;
    this.#key = `visuotactile-desk undo ${name}`;
    this.#storage = storage;
    this.#restore();
    history.addEventListener('change', ({ detail: { kind } }) => {
      if (kind === 'reset')
        this.#restore();
      else
        this.#unkept = true;
    });
    window.addEventListener('pagehide', () => this.keep());
    document.addEventListener('visibilitychange', () => this.keep());
  }

  /** What has changed since is written now; the page does so when it is hidden or left. */
  keep() {
    if (!this.#unkept)
      return;
    this.#unkept = false;
    let room = MOST;
    const newest = (steps) => steps.slice(steps.findLastIndex((step) => {
      room -= JSON.stringify(step).length;
      return room < 0;
    }) + 1);
    const { done, undone, track } = this.#history;
    try {
      this.#storage.setItem(this.#key, JSON.stringify({ print: track.fingerprint, done: newest(done), undone: newest(undone) }));
    } catch {
      // Without storage, the steps end with the page.
    }
  }

  #restore() {
    try {
      const kept = JSON.parse(this.#storage.getItem(this.#key));
      if (kept?.print === this.#history.track.fingerprint)
        this.#history.restore(kept);
    } catch {
      // What cannot be read is not restored.
    }
  }
}
