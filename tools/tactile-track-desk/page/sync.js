// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Sends edits to the desk in order, one request at a time. Edits that are made meanwhile wait and go
 * together. Each is in the browser's storage until the desk has it on its disk, so that a killed page
 * loses nothing; an edit that is sent again, because its answer was lost, keeps its name, by which the
 * desk knows it. With each is the fingerprint of the track before and after it, by which another page
 * knows whether it fits, as a desk that was started anew counts its revisions anew.
 *
 * @import {History} from './history.js'
 * @import {Track, Splice} from './track.js'
 * @typedef {{when: string, text: string, edits: Splice[][], cues?: object[]}} Kept
 *   what could not be sent, and the track with it
 */

/** Waits before the 1st, 2nd … attempt that follows one without an answer; ms. */
const WAITS = [250, 500, 1000, 2000, 5000];
/** Edits go together up to this many characters. */
const MOST = 1 << 20;

const later = (ms) => new Promise((done) => setTimeout(done, ms));
const newName = () => crypto.randomUUID().replaceAll('-', '');
const edits = (count) => (count === 1 ? '1 edit' : `${count} edits`);

export class Sync extends EventTarget {
  /**
   * @param {History} history
   * @param {object} desk
   * @param {string} desk.page this page's name
   * @param {(path: string, body: object) => Promise<{status: number, body: object}>} desk.send rejects
   *   if the desk cannot be reached
   * @param {number} desk.revision of the track
   * @param {number} desk.saved the revision that is in the file
   * @param {string} desk.name of the track, under which edits are stored
   * @param {Storage} [desk.storage]
   * @param {(ms: number) => Promise<void>} [desk.wait]
   */
  constructor(history, { page, send, revision, saved, name, storage = localStorage, wait = later }) {
    super();
    Object.assign(this, { history, page, send, revision, saved, storage, wait });
    this.prefix = `visuotactile-desk ${name} `;
    this.#print = history.track.fingerprint;
    history.addEventListener('change', ({ detail }) => {
      const before = this.#print;
      this.#print = history.track.fingerprint;
      if (detail.splices.length > 0) this.#add(detail.splices, before, this.#print);
    });
  }

  #queue = []; // {edit, splices, count, size, before, after}
  #print; // of the track
  #problem = null; // {state, text} while edits cannot be sent
  #sending = null; // the promise of a request in progress
  #wake = null;
  #unstored = false;

  /** Edits that the desk has not answered. */
  get pending() {
    return this.#queue.reduce((sum, { count }) => sum + count, 0);
  }

  get state() {
    if (this.#problem) return this.#problem.state;
    if (this.#queue.length > 0) return 'sending';
    return this.revision === this.saved ? 'saved' : 'journal';
  }

  /** The state for people. */
  get text() {
    const count = edits(this.pending);
    const kept = this.#unstored ? 'only in this page: do not close it' : 'kept in this browser';
    const error = this.#problem?.error;
    switch (this.state) {
      case 'saved': return 'Saved';
      case 'journal': return 'All edits are in the journal, not yet saved in the file';
      case 'sending': return `${count} on the way`;
      case 'reader': return `Another page writes. Not sent: ${count}, ${kept}. Take over to send`;
      case 'conflict': return `The track was changed elsewhere. Not sent: ${count}, ${kept}. Load it again`;
      case 'refused': return `Refused: ${error}. Not sent: ${count}, ${kept}. Load the track again`;
      default: return `Not sent: ${count}, ${kept}, tried again and again: ${error}`;
    }
  }

  #tell() {
    this.dispatchEvent(new Event('state'));
  }

  #add(splices, before, after) {
    const last = this.#queue.at(-1);
    // The first may be on its way, and keeps what it has.
    if (this.#queue.length > 1 && last.size < MOST) {
      last.splices.push(...splices);
      last.count++;
      last.size += JSON.stringify(splices).length;
      last.after = after;
    } else {
      const size = JSON.stringify(splices).length;
      this.#queue.push({ edit: newName(), splices: splices.slice(), count: 1, size, before, after });
    }
    this.#store();
    this.#tell();
    this.#run();
  }

  #store() {
    const key = this.prefix + this.page;
    try {
      if (this.#queue.length === 0) this.storage.removeItem(key);
      else this.storage.setItem(key, JSON.stringify(this.#queue));
      this.#unstored = false;
    } catch {
      this.#unstored = true;
    }
  }

  /** Sends until nothing is left or there is a problem. */
  #run() {
    this.#sending ??= this.#sendAll().finally(() => {
      this.#sending = null;
      if (this.#queue.length > 0 && !this.#problem) this.#run();
      else this.#tell();
    });
    return this.#sending;
  }

  async #sendAll() {
    let attempt = 0;
    while (this.#queue.length > 0 && (!this.#problem || this.#problem.state === 'waiting')) {
      const { edit, splices } = this.#queue[0];
      const answer = await this.#answer('edits', { edit, revision: this.revision, splices });
      this.#problem = this.#problemOf(answer);
      if (!this.#problem) {
        if (this.#queue[0]?.edit === edit) this.#queue.shift();
        ({ revision: this.revision, saved: this.saved } = answer.body);
        this.#store();
        attempt = 0;
      }
      this.#tell();
      if (this.#problem?.state === 'waiting') {
        const woken = new Promise((wake) => { this.#wake = wake; });
        await Promise.race([this.wait(WAITS[Math.min(attempt++, WAITS.length - 1)]), woken]);
      }
    }
  }

  /** The answer of a request; status 0 if there is none. */
  async #answer(path, body) {
    try {
      return await this.send(path, { page: this.page, ...body });
    } catch (error) {
      return { status: 0, body: { error: error.message } };
    }
  }

  #problemOf({ status, body }) {
    if (status === 200) return null;
    if (status === 0) return { state: 'waiting', error: 'tactile-track desk does not answer' };
    const error = body?.error ?? `status ${status}`;
    if (status === 423) return { state: 'reader', error };
    if (status === 409) return { state: 'conflict', error };
    return { state: status < 500 ? 'refused' : 'waiting', error };
  }

  /** Tries again at once, such as when this page may write now. */
  retry() {
    if (this.#problem?.state === 'reader') this.#problem = null;
    this.#wake?.();
    return this.#run();
  }

  /**
   * Saves the track after all edits are sent; with `over` even if another program has changed the file.
   * @returns the desk's answer. Rejects with an Error that says why it was not saved; `changed`: by another program.
   */
  async save({ over = false } = {}) {
    this.#wake?.();
    while (this.#queue.length > 0 && (!this.#problem || this.#problem.state === 'waiting')) {
      await this.#run();
    }
    if (this.#queue.length > 0) throw new Error(this.text);
    const answer = await this.#answer('save', { over });
    if (answer.status !== 200)
      throw Object.assign(new Error(answer.body?.error ?? `status ${answer.status}`), { changed: Boolean(answer.body?.changed) });
    ({ revision: this.revision, saved: this.saved } = answer.body);
    this.#tell();
    return answer.body;
  }

  /**
   * The track as the desk has it now. If edits that are not sent fit it, they are sent, and nothing else
   * changes: the desk was started again, and counts anew. Otherwise it is taken, and the edits are in `kept`.
   */
  reload(track, revision, saved) {
    const queue = this.#queue;
    const print = track.fingerprint;
    if (queue[0]?.after === print && queue[0].before !== print) queue.shift(); // its answer was lost
    const fits = this.#problem?.state !== 'refused' && print === (queue[0]?.before ?? this.#print);
    if (!fits && queue.length > 0) this.#keep(queue, this.text, this.history.track.cues);
    if (!fits) this.#queue = [];
    this.#problem = null;
    Object.assign(this, { revision, saved });
    this.#store();
    if (!fits) this.history.reset(track);
    this.#tell();
    if (this.#queue.length > 0) this.#run();
  }

  /**
   * Sends what pages that were killed had not sent. For the start, with the track as it was loaded and
   * once this page may write. If anything was sent, the track has to be loaded again, by reload().
   * What does not fit the track is kept.
   * @returns {Promise<{sent: number, kept: number}>} numbers of edits
   */
  async recover() {
    const found = { sent: 0, kept: 0 };
    let print = this.history.track.fingerprint;
    for (const key of this.#keys()) {
      const queue = this.#stored(key);
      // Its answer was lost.
      if (queue[0]?.after === print && queue[0].before !== print) queue.shift();
      while (queue.length > 0) {
        const { edit, splices, count, before, after } = queue[0];
        const answer = before !== print ? { status: 409, body: { error: 'the track has changed since' } }
          : await this.#answer('edits', { edit, revision: this.revision, splices });
        const problem = this.#problemOf(answer);
        if (problem?.state === 'reader' || problem?.state === 'waiting') return found; // all is still stored
        if (problem) {
          this.#keep(queue, problem.error);
          found.kept += queue.reduce((sum, one) => sum + one.count, 0);
          break;
        }
        ({ revision: this.revision, saved: this.saved } = answer.body);
        print = after;
        found.sent += count;
        queue.shift();
        if (queue.length > 0) this.storage.setItem(key, JSON.stringify(queue));
      }
      this.storage.removeItem(key);
    }
    return found;
  }

  /** What other pages have stored, the kept apart. */
  #keys() {
    const keys = [];
    for (let i = 0; i < this.storage.length; i++) keys.push(this.storage.key(i));
    return keys.filter((key) => key.startsWith(this.prefix) && key !== this.prefix + this.page
      && key !== `${this.prefix}kept`);
  }

  /** @returns {Kept[]} edits that could not be sent, for a download */
  get kept() {
    return this.#stored(`${this.prefix}kept`);
  }

  /** A list; empty if it is not there, or not one of this version. */
  #stored(key) {
    try {
      const list = JSON.parse(this.storage.getItem(key));
      return Array.isArray(list) ? list : [];
    } catch {
      return [];
    }
  }

  #keep(queue, text, cues) {
    const one = { when: new Date().toISOString(), text,
      edits: queue.map(({ splices }) => splices) };
    for (const entry of cues ? [{ ...one, cues }, one] : [one]) {
      try {
        this.storage.setItem(`${this.prefix}kept`, JSON.stringify([...this.kept, entry]));
        return;
      } catch { /* no room for all of it */ }
    }
  }

  /** Forgets one of `kept`. */
  forget(index) {
    this.storage.setItem(`${this.prefix}kept`, JSON.stringify(this.kept.filter((_, i) => i !== index)));
  }
}
