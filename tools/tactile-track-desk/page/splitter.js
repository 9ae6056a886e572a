// SPDX-License-Identifier: LGPL-2.1-or-later

const STORED = 'desk-layout';

function stored() {
  try {
    return JSON.parse(localStorage.getItem(STORED)) ?? {};
  } catch {
    return {};
  }
}

function store(name, value) {
  try {
    localStorage.setItem(STORED, JSON.stringify({ ...stored(), [name]: value }));
  } catch {
    // Without storage, the next page begins as usual.
  }
}

/**
 * A line between two parts of the page, which the pointer drags and arrow keys move. Enter and a double
 * click put it back. The browser remembers its place.
 */
export class Splitter {
  #element;
  #what;
  #value;

  /**
   * @param {HTMLElement} element with role separator and an id
   * @param {{usual: number, least: number, most: number, range: function(): [number, number],
   *   apply: function(number)}} what percent of the range, which is in pixels of the page
   */
  constructor(element, what) {
    this.#element = element;
    this.#what = what;
    element.tabIndex = 0;
    element.setAttribute('aria-valuemin', what.least);
    element.setAttribute('aria-valuemax', what.most);
    element.addEventListener('keydown', (event) => this.#key(event));
    element.addEventListener('dblclick', () => this.#move(what.usual));
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      event.preventDefault();
      element.focus();
    });
    element.addEventListener('pointermove', (event) => {
      if (element.hasPointerCapture(event.pointerId))
        this.#drag(event);
    });
    this.#show(Number(stored()[element.id]) || what.usual);
  }

  get #upright() { return this.#element.getAttribute('aria-orientation') === 'vertical'; }

  #drag({ clientX, clientY }) {
    const [from, to] = this.#what.range();
    this.#move(((this.#upright ? clientX : clientY) - from) / Math.max(to - from, 1) * 100);
  }

  #key(event) {
    const { least, most, usual } = this.#what;
    const [less, more] = this.#upright ? ['ArrowLeft', 'ArrowRight'] : ['ArrowUp', 'ArrowDown'];
    const to = { [less]: this.#value - 2, [more]: this.#value + 2, Home: least, End: most, Enter: usual }[event.key];
    if (to === undefined)
      return;
    event.preventDefault();
    event.stopPropagation();
    this.#move(to);
  }

  #move(value) {
    this.#show(value);
    store(this.#element.id, this.#value);
  }

  #show(value) {
    const { least, most, apply } = this.#what;
    this.#value = Math.min(Math.max(value, least), most);
    const shown = Math.round(this.#value);
    this.#element.setAttribute('aria-valuenow', shown);
    this.#element.setAttribute('aria-valuetext', `${shown} %`);
    apply(this.#value);
  }
}
