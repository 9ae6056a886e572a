// SPDX-License-Identifier: LGPL-2.1-or-later
import { Recorder } from './recorder.js';

const TRIGGER = 7; // of the Gamepad API's standard mapping: right trigger
const BUTTON = 0; // lower face button
const NUMPAD = ['Numpad7', 'Numpad8', 'Numpad9', 'Numpad4', 'Numpad5', 'Numpad6', 'Numpad1', 'Numpad2', 'Numpad3'];

/**
 * The grid as buttons on which one paints: held while the film plays, a stamp while it stands.
 * Not recording, a press is only felt.
 *
 * Events: 'paint' (detail: spans), 'press' (detail: {levels}) for a press that is only felt.
 */
export class Grid extends EventTarget {
  #film;
  #buttons = [];
  #rows;
  #columns;
  #rate;
  #before = 0; // position at the last tick
  #stick = null; // cell that the gamepad holds
  #frame = 0;

  /**
   * @param {HTMLElement} element empty, gets the buttons
   * @param {Film} film
   * @param {{grid: number[], rate: number}} track of the session
   */
  constructor(element, film, track) {
    super();
    this.#film = film;
    [this.#rows, this.#columns] = track.grid;
    this.#rate = track.rate;
    /** Percent, of what is painted. */
    this.level = 75;
    this.recording = false;
    this.readOnly = false;
    this.recorder = new Recorder((spans) => this.#painted(spans));
    element.style.gridTemplateColumns = `repeat(${this.#columns}, minmax(0, 1fr))`;
    for (let cell = 0; cell < this.#rows * this.#columns; cell++)
      element.append(this.#button(cell));
    element.addEventListener('keydown', (event) => this.#arrows(event));
    for (const name of ['pointerup', 'pointercancel'])
      window.addEventListener(name, (event) => this.#release(`pointer ${event.pointerId}`));
    window.addEventListener('keyup', (event) => this.#release(event.code));
    window.addEventListener('blur', () => this.#stop());
    film.addEventListener('time', () => this.#time());
    film.addEventListener('state', () => film.paused && this.#stop());
    window.addEventListener('gamepadconnected', () => this.#watch());
    this.#watch();
  }

  /** The cell of a digit, of the number block by its place, or null. */
  cellOf(event) {
    const place = NUMPAD.indexOf(event.code);
    if (place >= 0) {
      const [row, column] = [Math.floor(place / 3), place % 3];
      return row < this.#rows && column < this.#columns ? row * this.#columns + column : null;
    }
    const digit = /^Digit([1-9])$/.exec(event.code)?.[1] - 1;
    return digit < this.#rows * this.#columns ? digit : null;
  }

  /** A key goes down on a cell. */
  key(event, cell) {
    if (!event.repeat)
      this.#press(cell, this.level, event.code);
  }

  /** Shows a map, with what is held over it. Cells that stay the same cost no layout. */
  show(levels) {
    this.#buttons.forEach((button, cell) => {
      const held = this.recorder.held.get(cell)?.level;
      const level = held ?? levels[cell];
      const shown = `${level} ${held !== undefined}`;
      if (button.dataset.shown === shown)
        return;
      button.dataset.shown = shown;
      button.style.setProperty('--level', level / 100);
      button.classList.toggle('held', held !== undefined);
      button.lastChild.textContent = level ? `${level}` : '';
    });
  }

  #button(cell) {
    const button = document.createElement('button');
    const place = `row ${Math.floor(cell / this.#columns) + 1}, column ${(cell % this.#columns) + 1}`;
    button.type = 'button';
    button.tabIndex = cell === 0 ? 0 : -1;
    button.setAttribute('aria-label', `Cell ${cell + 1}: ${place}`);
    if (cell < 9)
      button.setAttribute('aria-keyshortcuts', `${cell + 1}`);
    const name = document.createElement('kbd');
    name.textContent = cell < 9 ? `${cell + 1}` : '';
    button.append(name, document.createElement('span'));
    button.addEventListener('pointerdown', (event) => {
      if (event.button === 0)
        this.#press(cell, this.level, `pointer ${event.pointerId}`);
    });
    button.addEventListener('keydown', (event) => {
      if (event.key === ' ' || event.key === 'Enter') {
        event.preventDefault();
        event.stopPropagation();
        this.key(event, cell);
      }
    });
    // A screen reader's press comes without pointer and key.
    button.addEventListener('click', (event) => {
      if (event.detail === 0 && event.pointerType === '') {
        this.#press(cell, this.level, 'click');
        this.#release('click');
      }
    });
    this.#buttons.push(button);
    return button;
  }

  #arrows(event) {
    const from = this.#buttons.indexOf(event.target);
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -this.#columns, ArrowDown: this.#columns }[event.key];
    const to = this.#buttons[from + step];
    if (from < 0 || !to)
      return;
    event.preventDefault();
    this.#buttons[from].tabIndex = -1;
    to.tabIndex = 0;
    to.focus();
  }

  #press(cell, level, by) {
    if (!this.recording || this.readOnly) {
      const levels = this.#buttons.map((_, i) => (i === cell ? level : 0));
      this.dispatchEvent(new CustomEvent('press', { detail: { levels } }));
      return;
    }
    if (!this.#film.paused) {
      this.recorder.press(cell, level, this.#film.position, by);
      return;
    }
    const start = this.#film.position;
    const end = start + Math.round(1000 / (this.#rate || 5));
    this.#painted([{ cell, start, end, level }]);
  }

  #release(by) { this.recorder.release(by, this.#film.position); }

  #stop() {
    this.recorder.stop(this.#film.position);
    this.#stick = null;
  }

  #time() {
    const now = this.#film.position;
    if (this.recorder.held.size && (now < this.#before || now > this.#before + 2000))
      this.recorder.leap(this.#before, now);
    this.#before = now;
  }

  #painted(spans) { this.dispatchEvent(new CustomEvent('paint', { detail: spans })); }

  /** Gamepads have no events for their buttons: they are looked at while one is there. */
  #watch() {
    cancelAnimationFrame(this.#frame);
    const pad = navigator.getGamepads().find((each) => each?.connected);
    if (!pad)
      return;
    this.#poll(pad);
    this.#frame = requestAnimationFrame(() => this.#watch());
  }

  #poll({ axes, buttons }) {
    const trigger = buttons[TRIGGER]?.value ?? 0;
    const level = trigger > 0.05 ? Math.max(10, Math.round(trigger * 10) * 10) : this.level;
    if (trigger <= 0.05 && !buttons[BUTTON]?.pressed) {
      if (this.#stick !== null)
        this.#release('stick');
      this.#stick = null;
      return;
    }
    const along = (axis, count) => Math.min(count - 1, Math.floor(((axis ?? 0) + 1) / 2 * count));
    const cell = along(axes[1], this.#rows) * this.#columns + along(axes[0], this.#columns);
    if (this.recording && !this.readOnly && !this.#film.paused)
      this.recorder.press(cell, level, this.#film.position, 'stick');
    else if (cell !== this.#stick)
      this.#press(cell, level, 'stick');
    this.#stick = cell;
  }
}
