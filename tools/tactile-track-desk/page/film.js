// SPDX-License-Identifier: LGPL-2.1-or-later

import { frameFrom } from './time.js';

/**
 * The film and its transport, whether the browser plays the file itself or the desk's proxy stream.
 *
 * Events: 'time' whenever the position may have changed, 'leap' (detail: {user}) after a jump,
 * 'state' (played, paused, another rate), 'fail' (detail: text).
 */
export class Film extends EventTarget {
  #video;
  #film;
  #offset = 0; // ms: where the proxy stream begins
  #proxy = false;
  #target = null; // ms: the whole ms that a seek asked for, until the film moves on
  #byUser = true;
  #reload = 0;
  #opening = false; // the proxy stream, at another place
  #frame = 0;

  /** @param {HTMLVideoElement} video @param {object} film of the session */
  constructor(video, film) {
    super();
    this.#video = video;
    this.#film = film;
    this.loop = null; // {from, to} in ms, or null
    const state = () => this.dispatchEvent(new Event('state'));
    video.addEventListener('play', () => {
      state();
      this.#nextTick();
    });
    for (const name of ['pause', 'ratechange', 'volumechange', 'ended', 'waiting', 'playing'])
      video.addEventListener(name, state);
    video.addEventListener('seeked', () => this.#leapt());
    video.addEventListener('loadeddata', () => this.#changed());
    video.addEventListener('error', () => this.#failed());
    if (film.type && !video.canPlayType(film.type))
      this.#open(0);
    else
      video.src = 'film';
  }

  get duration() { return this.#film.duration; }
  get paused() { return this.#video.paused || this.#video.ended; }
  /** Plays, but shows no new frames: it waits for data. */
  get stalled() { return !this.paused && (this.#isSeeking || this.#video.readyState < 3); }
  get rate() { return this.#video.playbackRate; }
  set rate(rate) { this.#video.playbackRate = this.#video.defaultPlaybackRate = rate; }
  get muted() { return this.#video.muted; }
  set muted(muted) { this.#video.muted = muted; }

  get #isSeeking() { return this.#opening || this.#video.seeking; }

  /** Whole ms. */
  get position() {
    if (this.#target !== null && (this.#video.paused || this.#isSeeking))
      return this.#target;
    return this.#clamp(Math.round(this.#offset + this.#video.currentTime * 1000));
  }

  /** ms of a frame; 40 for a film that does not say. */
  get frame() { return this.#film.frameDuration || 40; }

  async play() {
    if (this.loop && (this.position < this.loop.from || this.position >= this.loop.to))
      this.seek(this.loop.from);
    else if (this.position >= this.duration - 1)
      this.seek(0);
    try {
      await this.#video.play();
    } catch (error) {
      if (error.name !== 'AbortError')
        this.dispatchEvent(new CustomEvent('fail', { detail: `The film does not play: ${error.message}` }));
    }
  }

  pause() { this.#video.pause(); }
  toggle() { return this.paused ? this.play() : this.pause(); }

  /** @param {number} ms @param {boolean} user false: a loop, not a hand */
  seek(ms, user = true) {
    const target = this.#clamp(Math.round(ms));
    this.#target = target;
    this.#byUser = user;
    const time = (target - this.#offset) / 1000;
    if (!this.#proxy || this.#isBuffered(time))
      this.#video.currentTime = time;
    else
      this.#open(target);
    this.#changed();
  }

  /** Goes to the begin of a frame nearby. The film pauses. */
  step(frames) {
    this.pause();
    this.seek(frameFrom(this.position, this.frame, frames));
  }

  #clamp(ms) { return Math.max(0, this.duration ? Math.min(ms, this.duration) : ms); }

  #isBuffered(time) {
    const ranges = this.#video.buffered;
    for (let i = 0; i < ranges.length; i++) {
      if (time >= ranges.start(i) && time < ranges.end(i))
        return true;
    }
    return false;
  }

  /** The proxy stream from there on; of several seeks in a row the last one counts. */
  #open(target) {
    const playing = !this.#video.paused;
    this.#proxy = true;
    this.#opening = true;
    clearTimeout(this.#reload);
    this.#reload = setTimeout(() => {
      this.#offset = target;
      const { defaultPlaybackRate } = this.#video;
      this.#video.src = `film.webm?from=${target / 1000}`;
      this.#video.playbackRate = defaultPlaybackRate;
      this.#video.addEventListener('loadeddata', () => {
        this.#opening = false;
        this.#leapt();
      }, { once: true });
      if (playing)
        this.#video.play().catch(() => {});
    }, this.#video.src ? 150 : 0);
  }

  #leapt() {
    this.dispatchEvent(new CustomEvent('leap', { detail: { user: this.#byUser } }));
    this.#changed();
  }

  #changed() { this.dispatchEvent(new Event('time')); }

  #tick() {
    if (this.paused)
      return;
    const { loop } = this;
    if (!this.#isSeeking)
      this.#target = null;
    if (loop && !this.#isSeeking && (this.position >= loop.to || this.position < loop.from - 50))
      this.seek(loop.from, false);
    this.#changed();
    this.#nextTick();
  }

  #nextTick() {
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => this.#tick());
  }

  #failed() {
    this.#opening = false;
    const unplayable = [MediaError.MEDIA_ERR_DECODE, MediaError.MEDIA_ERR_SRC_NOT_SUPPORTED];
    if (!this.#proxy && unplayable.includes(this.#video.error.code)) {
      this.#open(this.position);
      return;
    }
    const detail = `The film cannot be shown: ${this.#video.error.message || 'no reason was told'}. ` +
      'The track can be edited without it.';
    this.dispatchEvent(new CustomEvent('fail', { detail }));
  }
}
