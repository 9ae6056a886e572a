// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Where things are on the timeline: time to the right, below each other a ruler, thumbnails, the
 * waveform and a row a cell. Lengths are CSS pixels, `scale` is ms a pixel.
 */

/** Width of the rows' labels. */
export const GUTTER = 76;
export const RULER = 26;
const STRIP = 48;
const WAVE = 36;
const LEAST_ROW = 18;
/** Height of a row whose levels are edited. */
const TALL_ROW = 72;
/** A pixel is at least so long: then a frame of a film of 25 a second is 800 pixels wide. */
const FINEST = 0.05;
/** How near a pointer has to be to an edge. */
const NEAR = 6;

export class TimelineView {
  width = 0;
  height = 0;
  from = 0; // ms at the left edge of the rows
  scale = 10;
  scroll = 0; // of the rows, pixels
  tall = false; // rows are high, and not all in view

  /** @param {number} cells */
  constructor(cells) {
    this.cells = cells;
    this.show({ strip: false, wave: false, length: 1000 });
  }

  /** What is above the rows, and the length of all, ms. */
  show({ strip = this.hasStrip, wave = this.hasWave, length = this.length }) {
    Object.assign(this, { hasStrip: strip, hasWave: wave, length: Math.max(length, 1000) });
    this.stripTop = RULER;
    this.waveTop = this.stripTop + (strip ? STRIP : 0);
    this.rowsTop = this.waveTop + (wave ? WAVE : 0);
    this.fit();
  }

  resize(width, height) {
    const isWhole = this.width === 0 || (this.from === 0 && this.to >= this.length);
    Object.assign(this, { width, height });
    if (isWhole) this.zoomTo(0, this.length);
    else this.fit();
  }

  /** Width of the rows. */
  get span() {
    return Math.max(this.width - GUTTER, 1);
  }

  get hasHiddenRows() {
    return this.rowHeight * this.cells > this.height - this.rowsTop + 0.5;
  }

  get to() {
    return this.from + this.span * this.scale;
  }

  get rowHeight() {
    return Math.max((this.height - this.rowsTop) / this.cells, this.tall ? TALL_ROW : LEAST_ROW);
  }

  /** Height of a bar of 100 %; below it is room for warnings. */
  get barRoom() {
    return this.rowHeight - 9;
  }

  /** Keeps all within what there is. */
  fit() {
    this.scale = Math.min(Math.max(this.scale, FINEST), Math.max(this.length / this.span, FINEST));
    this.from = Math.max(Math.min(this.from, this.length - this.span * this.scale), 0);
    const most = this.rowsTop + this.rowHeight * this.cells - this.height;
    this.scroll = Math.max(Math.min(this.scroll, most), 0);
  }

  x(ms) {
    return GUTTER + (ms - this.from) / this.scale;
  }

  ms(x) {
    return this.from + (x - GUTTER) * this.scale;
  }

  top(cell) {
    return this.rowsTop + cell * this.rowHeight - this.scroll;
  }

  /** Cells [first, last) that are in view. */
  get visibleCells() {
    const first = Math.floor(this.scroll / this.rowHeight);
    const last = Math.ceil((this.scroll + this.height - this.rowsTop) / this.rowHeight);
    return [Math.max(first, 0), Math.min(last, this.cells)];
  }

  cellAt(y) {
    const cell = Math.floor((y - this.rowsTop + this.scroll) / this.rowHeight);
    return Math.min(Math.max(cell, 0), this.cells - 1);
  }

  /** Zooms by a factor, above 1: closer; `ms` stays where it is. */
  zoom(factor, ms) {
    const x = this.x(ms);
    this.scale /= factor;
    this.fit();
    this.from = ms - (x - GUTTER) * this.scale;
    this.fit();
  }

  zoomTo(from, to) {
    this.scale = Math.max((to - from) / this.span, FINEST);
    this.from = from;
    this.fit();
  }

  pan(pixels) {
    this.from += pixels * this.scale;
    this.fit();
  }

  scrollRows(pixels) {
    this.scroll += pixels;
    this.fit();
  }

  /** @returns whether anything had to move to bring a time, and a cell, into view */
  reveal(ms, cell = null) {
    const { from, scroll } = this;
    if (ms < this.from || ms >= this.to) this.from = ms - 0.1 * this.span * this.scale;
    if (cell !== null) {
      const top = cell * this.rowHeight;
      const least = top + this.rowHeight - (this.height - this.rowsTop);
      this.scroll = Math.min(Math.max(this.scroll, least), top);
    }
    this.fit();
    return from !== this.from || scroll !== this.scroll;
  }

  /** Of the bar of a level in its row: [y, height]. */
  bar(cell, level) {
    const height = Math.max(Math.round(level / 100 * this.barRoom), 2);
    return [Math.round(this.top(cell) + this.rowHeight) - 6 - height, height];
  }

  /** The level whose bar ends at a height in a row. */
  levelAt(cell, y) {
    const [bottom] = this.bar(cell, 0);
    return Math.min(Math.max(Math.round((bottom + 2 - y) / this.barRoom * 100), 0), 100);
  }

  /**
   * What is at a place.
   * @param {import('./track.js').Track} track
   * @returns {{part: 'label'|'time'|'empty'|'begin'|'end'|'level'|'event', cell?: number, ms: number,
   *   event?: import('./track.js').Span}}
   */
  hit(track, x, y) {
    const ms = this.ms(x);
    if (y < this.rowsTop) return { part: 'time', ms };
    const cell = this.cellAt(y);
    if (x < GUTTER) return { part: 'label', cell, ms };
    const near = NEAR * this.scale;
    const at = Math.floor(ms);
    const event = track.eventAt(cell, at) ?? this.#eventNear(track, cell, ms, near);
    if (!event) return { part: 'empty', cell, ms };
    // Of a narrow one, the middle third moves it.
    const edge = Math.min(near, (event.end - event.start) / 3);
    if (ms < event.start + edge) return { part: 'begin', cell, ms, event };
    if (ms > event.end - edge) return { part: 'end', cell, ms, event };
    // Of a low one, most of what is below its top moves it, too.
    const [top, height] = this.bar(cell, track.level(cell, at));
    return { part: y > top - 4 && y < top + Math.min(4, height / 4) ? 'level' : 'event', cell, ms, event };
  }

  #eventNear(track, cell, ms, near) {
    for (const event of track.events(cell, Math.floor(ms - near), Math.ceil(ms + near))) return event;
    return null;
  }
}

/** Steps of the ruler, ms. */
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 15_000, 30_000, 60_000,
  120_000, 300_000, 600_000, 900_000, 1_800_000, 3_600_000, 7_200_000, 18_000_000];

/** The step of the ruler for which labels of `room` pixels do not touch. */
export function rulerStep(scale, room = 76) {
  return STEPS.find((step) => step / scale >= room) ?? STEPS.at(-1);
}
