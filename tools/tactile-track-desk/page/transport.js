// SPDX-License-Identifier: LGPL-2.1-or-later
import { failed } from './notices.js';
import { formatTime, parseTime } from './time.js';

const $ = (id) => document.getElementById(id);

/** The buttons and fields below the film. */
export class Transport {
  #film;
  #shown = []; // what the buttons say
  #timed = 0; // performance.now() of what the field says
  #rates = [...$('rate').options].map(({ value }) => Number(value));

  /**
   * @param {import('./film.js').Film} film
   * @param {function()} done a time was typed and Enter pressed
   */
  constructor(film, done) {
    this.#film = film;
    $('duration').textContent = formatTime(film.duration);
    const click = (id, act) => $(id).addEventListener('click', act);
    click('back', () => film.step(-1));
    click('forward', () => film.step(1));
    click('play', () => film.toggle());
    click('mute', () => this.toggleSound());
    $('rate').addEventListener('change', () => { film.rate = Number($('rate').value); });
    $('time').addEventListener('change', () => this.#goTo());
    $('time').addEventListener('keydown', (event) => {
      if (event.key !== 'Enter')
        return;
      event.preventDefault();
      if (this.#goTo())
        done();
    });
  }

  /** @param {number} by 1: faster, -1: slower */
  changeRate(by) { this.#film.rate = this.#rates[this.#rates.indexOf(this.#film.rate) + by] ?? this.#film.rate; }

  toggleSound() { this.#film.muted = !this.#film.muted; }

  /** To the field, so that a time can be typed. */
  focus() {
    $('time').focus();
    $('time').select();
  }

  show() {
    const film = this.#film;
    const now = performance.now();
    // A changed field costs more than all else of the page.
    if (document.activeElement !== $('time') && (film.paused || now - this.#timed >= 100)) {
      this.#timed = now;
      $('time').value = formatTime(film.position);
    }
    const state = [film.paused, film.muted, Boolean(film.loop), film.rate];
    if (state.every((one, i) => one === this.#shown[i]))
      return;
    this.#shown = state;
    $('play').textContent = film.paused ? 'Play' : 'Pause';
    $('mute').setAttribute('aria-pressed', film.muted);
    $('loop').setAttribute('aria-pressed', Boolean(film.loop));
    $('rate').value = film.rate;
  }

  /** @returns {boolean} whether what was typed is a time */
  #goTo() {
    try {
      this.#film.seek(parseTime($('time').value));
      return true;
    } catch (thrown) {
      failed(thrown);
      return false;
    }
  }
}
