// SPDX-License-Identifier: LGPL-2.1-or-later
import { Splitter } from './splitter.js';

const $ = (id) => document.getElementById(id);

/** How much room film, grid, panel and timeline have: splitters, and the film over the whole screen. */
export class Layout {
  /** @param {function()} changed the film is shown at another size */
  constructor(changed) {
    const main = document.querySelector('main');
    const share = (name, percent) => main.style.setProperty(`--${name}`, `${percent}fr`);
    const places = { film: 0, grid: 0 };
    const columns = (place) => {
      const { film, grid } = Object.assign(places, place);
      const rest = 100 - film;
      share('film', film);
      share('grid', rest * grid / 100);
      share('panel', rest - rest * grid / 100);
    };
    const box = (element) => element.getBoundingClientRect();
    new Splitter($('split-film'), { usual: 43, least: 20, most: 70,
      range: () => [box(main).left, box(main).right],
      apply: (film) => columns({ film }) });
    new Splitter($('split-grid'), { usual: 46, least: 30, most: 60,
      range: () => [box($('split-film')).right, box(main).right],
      apply: (grid) => columns({ grid }) });
    new Splitter($('split-track'), { usual: 45, least: 20, most: 75,
      range: () => [box(main).top, box(main).bottom],
      apply: (value) => {
        share('top', value);
        share('bottom', 100 - value);
      } });
    new ResizeObserver(changed).observe(document.querySelector('.screen'));
    $('full').addEventListener('click', () => this.toggleFull());
    document.addEventListener('fullscreenchange', () => this.#show(document.fullscreenElement !== null));
  }

  /** The film fills the screen, with the grid over it; if the browser refuses, it fills the window. */
  async toggleFull() {
    const full = !document.body.classList.contains('full');
    this.#show(full);
    try {
      if (full)
        await document.documentElement.requestFullscreen();
      else if (document.fullscreenElement)
        await document.exitFullscreen();
    } catch {
      // It fills the window.
    }
  }

  #show(full) {
    if (full && !document.body.classList.contains('full'))
      this.focused = document.activeElement;
    document.body.classList.toggle('full', full);
    $('full').setAttribute('aria-pressed', full);
    // Space plays in both.
    const focus = full ? $('play') : this.focused;
    if (focus?.checkVisibility())
      focus.focus();
  }
}
