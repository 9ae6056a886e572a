// SPDX-License-Identifier: LGPL-2.1-or-later
import { send } from './desk.js';
import { Pad } from './pad.js';

const TELL = 200; // ms: how often the chair hears where the film is
const BRIEF = 150; // ms: how long the frame is felt that a scrub stops at

/** What is seen is felt: the desk's chair hears where the film is, the gamepad plays the maps. */
export class Feel {
  #film;
  #page;
  #levelsAt;
  #columns;
  #told = -Infinity; // ms, performance.now()
  #asking = false;
  #waiting = null; // the newest request that waits for the one before
  #briefUntil = 0;

  /**
   * @param {Film} film @param {string} page @param {number} columns
   * @param {function(number): number[]} levelsAt the map at a time in ms
   */
  constructor(film, page, columns, levelsAt) {
    this.#film = film;
    this.#page = page;
    this.#columns = columns;
    this.#levelsAt = levelsAt;
    this.pad = new Pad();
    /** The chair is told: this page writes, and the box is ticked. */
    this.chair = false;
    film.addEventListener('state', () => this.#state());
    film.addEventListener('leap', ({ detail }) => this.#leap(detail.user));
    film.addEventListener('time', () => this.#time());
    window.addEventListener('pagehide', () => this.#tell({ paused: true }));
  }

  /** A map is felt for a moment while the film stands. */
  brief(levels, duration = BRIEF) {
    if (!this.#film.paused)
      return;
    if (levels.some((level) => level > 0))
      this.#post('feel', { page: this.#page, levels: [...levels], duration });
    const until = this.#briefUntil = performance.now() + duration;
    const renew = () => {
      if (until !== this.#briefUntil || !this.#film.paused)
        return;
      if (performance.now() >= until)
        this.pad.stop();
      else {
        this.pad.play(levels, this.#columns);
        setTimeout(renew, 50);
      }
    };
    renew();
  }

  #moving() { return !this.#film.paused && !this.#film.stalled; }

  #state() {
    if (!this.#moving())
      this.pad.stop();
    this.#tell();
  }

  #leap(byUser) {
    this.#tell({ leap: true });
    if (this.#film.paused && byUser)
      this.brief(this.#levelsAt(this.#film.position));
  }

  #time() {
    if (!this.#moving())
      return;
    this.pad.play(this.#levelsAt(this.#film.position), this.#columns);
    if (performance.now() - this.#told >= TELL)
      this.#tell();
  }

  #tell(more = {}) {
    this.#told = performance.now();
    this.#post('position', {
      page: this.#page, position: this.#film.position, rate: this.#film.rate, paused: !this.#moving(),
      leap: false, ...more,
    });
  }

  /** One request at a time, so that none overtakes another; only the newest one waits. */
  async #post(path, body) {
    if (!this.chair)
      return;
    if (this.#asking) {
      const leap = Boolean(body.leap || (path === 'position' && this.#waiting?.body.leap));
      this.#waiting = { path, body: path === 'position' ? { ...body, leap } : body };
      return;
    }
    this.#asking = true;
    try {
      await send(path, body, { keepalive: true });
    } catch {
      // The desk is gone, which its events tell; its chair is at zero by itself.
    }
    this.#asking = false;
    const waiting = this.#waiting;
    this.#waiting = null;
    if (waiting)
      this.#post(waiting.path, waiting.body);
  }
}
