// SPDX-License-Identifier: LGPL-2.1-or-later

/** A list of tabs, each for a pane, of which one is shown: arrow keys, Home and End choose. */
export class Tabs {
  #tabs;

  /** @param {HTMLElement} list with role tablist; each tab names its pane in aria-controls */
  constructor(list) {
    this.#tabs = [...list.querySelectorAll('[role=tab]')];
    for (const tab of this.#tabs)
      tab.addEventListener('click', () => this.show(tab));
    list.addEventListener('keydown', (event) => this.#key(event));
    this.show(this.#tabs[0]);
  }

  /** @param {HTMLElement} shown a tab, or something within its pane */
  show(shown) {
    for (const tab of this.#tabs) {
      const pane = document.getElementById(tab.getAttribute('aria-controls'));
      const selected = tab === shown || pane.contains(shown);
      tab.setAttribute('aria-selected', selected);
      tab.tabIndex = selected ? 0 : -1;
      pane.hidden = !selected;
    }
  }

  #key(event) {
    const last = this.#tabs.length - 1;
    const at = this.#tabs.indexOf(event.target);
    const to = { ArrowLeft: at > 0 ? at - 1 : last, ArrowRight: at < last ? at + 1 : 0, Home: 0, End: last }[event.key];
    if (to === undefined)
      return;
    event.preventDefault();
    this.show(this.#tabs[to]);
    this.#tabs[to].focus();
  }
}
