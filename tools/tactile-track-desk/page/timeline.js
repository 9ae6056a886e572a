// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * The timeline: a row a cell, with events as high as their level, the draft as a shadow behind them,
 * the film's pictures, sound and shot cuts, and where motor limits are broken.
 *
 * Events: `seek` {ms, scrubbing}, `select` {selection}, `loop` {loop}, `level` {level}, `tool`, `view`,
 * `drawn`.
 *
 * @import {History} from './history.js'
 * @import {Track, Selection, Span} from './track.js'
 */
import * as strokes from './strokes.js';
import { TimelineGestures } from './timeline_gestures.js';
import { TimelineKeys } from './timeline_keys.js';
import { TimelinePainter } from './timeline_painter.js';
import { TimelineView } from './timeline_view.js';
import { formatTime } from './time.js';
import { cellName } from './track.js';

export { KEYS } from './timeline_keys.js';

let count = 0;

export class Timeline extends EventTarget {
  /** In view while the film plays. */
  follow = true;
  readOnly = false;
  /** The row that keys are for. */
  cell = 0;
  /** What a gesture would make: Span[]. */
  ghost = [];
  /** Points of a curve that a gesture would make, or null. */
  points = null;
  /** The point of a curve that keys have selected, among those of its event: {cell, points, index}, or null. */
  held = null;
  /** Impacts of the sound, ms, in order. */
  impacts = [];
  hasFocus = false;

  /**
   * @param {HTMLElement} element an empty one, which has a size
   * @param {{history: History, film: {duration: number, frameDuration: number}}} what durations in ms,
   *   0 if unknown
   */
  constructor(element, { history, film }) {
    super();
    this.history = history;
    this.frame = film.frameDuration > 0 ? film.frameDuration : 40;
    this.duration = film.duration;
    this.view = new TimelineView(history.track.cells);
    this.view.show({ length: this.length });
    this.#build(element);
    this.painter = new TimelinePainter(this.canvas);
    new TimelineGestures(this);
    new TimelineKeys(this);
    history.addEventListener('change', ({ detail: { kind } }) => {
      if (kind === 'reset') this.selection = null;
      this.view.show({ length: this.length });
      this.refresh();
    });
    this.#watch(element);
  }

  #draft = null;
  #warnings = [];
  #cuts = [];
  #peaks = new Uint8Array(0);
  #playhead = 0;
  #selection = null;
  #loop = null;
  #level = 75;
  #tool = 'draw';
  #snap = true;
  #drawn = null; // the frame that is asked for
  strip = null;
  thumbnail = () => null;

  #build(element) {
    const make = (tag, attributes) => {
      const made = document.createElement(tag);
      for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
      return element.appendChild(made);
    };
    const help = `timeline-help-${++count}`;
    this.canvas = make('canvas', { tabindex: '0', role: 'application', 'aria-roledescription': 'timeline',
      'aria-label': 'Timeline', 'aria-describedby': help });
    make('p', { id: help, class: 'visually-hidden' }).textContent = 'Left and right: a frame. Up and down: a '
      + 'cell. Shift selects. Enter draws. The help lists all keys, the table of cues what is near.';
    this.live = make('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
    // It is as large as its element, which it must not stretch.
    element.style.position = 'relative';
    Object.assign(this.canvas.style, { position: 'absolute', inset: '0', width: '100%', height: '100%',
      touchAction: 'none', outline: 'none' });
  }

  #watch(element) {
    const resized = () => {
      if (element.clientWidth === 0 && this.view.width > 0) return; // hidden: it is shown as it was
      this.view.resize(element.clientWidth, element.clientHeight);
      this.refresh();
    };
    new ResizeObserver(resized).observe(element);
    resized();
    for (const query of ['(prefers-color-scheme: dark)', '(forced-colors: active)']) {
      matchMedia(query).addEventListener('change', () => {
        this.painter.readColors();
        this.refresh();
      });
    }
    for (const name of ['focus', 'blur']) {
      this.canvas.addEventListener(name, () => {
        this.hasFocus = name === 'focus' && this.canvas.matches(':focus-visible');
        this.refresh();
      });
    }
  }

  /** Draws at the next frame. */
  refresh() {
    this.#drawn ??= requestAnimationFrame(() => {
      this.#drawn = null;
      this.painter.resize(this.view, devicePixelRatio);
      this.painter.paint(this);
      this.#tell('drawn', {});
    });
  }

  /** Of film and track, ms. */
  get length() {
    return Math.max(this.duration, this.history.track.end, this.#draft?.end ?? 0);
  }

  focus() {
    this.canvas.focus();
  }

  /** @returns {Track|null} the shadow behind the events */
  get draft() {
    return this.#draft;
  }

  set draft(track) {
    this.#draft = track;
    this.view.show({ length: this.length });
    this.refresh();
  }

  /** As those of Limits. */
  get warnings() {
    return this.#warnings;
  }

  set warnings(warnings) {
    this.#warnings = warnings;
    this.refresh();
  }

  /** Shot cuts, ms, in order. */
  get cuts() {
    return this.#cuts;
  }

  set cuts(cuts) {
    this.#cuts = cuts;
    this.refresh();
  }

  /** @returns {Uint8Array} the sound's peaks, one each 10 ms */
  get peaks() {
    return this.#peaks;
  }

  set peaks(peaks) {
    this.#peaks = peaks;
    this.view.show({ wave: peaks.length > 0 });
    this.refresh();
  }

  /**
   * Thumbnails.
   * @param {{interval: number, width: number, height: number, total: number}|null} strip
   * @param {(index: number) => CanvasImageSource|null} image null while it is not there; then refresh()
   */
  setStrip(strip, image) {
    this.strip = strip;
    this.thumbnail = image;
    this.view.show({ strip: Boolean(strip?.total) });
    this.refresh();
  }

  get playhead() {
    return this.#playhead;
  }

  set playhead(ms) {
    if (ms === this.#playhead) return;
    const pixel = () => Math.round(this.view.x(this.#playhead) * devicePixelRatio);
    const before = pixel();
    this.#playhead = ms;
    const moved = this.follow && this.view.reveal(ms);
    if (moved) this.#tell('view', {});
    if (moved || pixel() !== before) this.refresh();
  }

  /** Moves the playhead and lets the film follow. */
  seek(ms, { scrubbing = false } = {}) {
    this.playhead = Math.round(Math.min(Math.max(ms, 0), this.length));
    this.#tell('seek', { ms: this.playhead, scrubbing });
  }

  /** @returns {Selection|null} */
  get selection() {
    return this.#selection;
  }

  set selection(selection) {
    this.#selection = selection;
    this.#tell('select', { selection });
    this.refresh();
  }

  /** Cells of the selection, else the current one. */
  get cells() {
    return this.#selection ? this.#selection.cells ?? [...this.history.track.silence.keys()] : [this.cell];
  }

  get loop() {
    return this.#loop;
  }

  set loop(loop) {
    const { from, to } = this.#loop ?? {};
    if (loop?.from === from && loop?.to === to) return;
    this.#loop = loop;
    this.#tell('loop', { loop });
    this.refresh();
  }

  /** Of what is drawn, 1 to 100. */
  get level() {
    return this.#level;
  }

  set level(level) {
    level = Math.min(Math.max(Math.round(level), 1), 100);
    if (level === this.#level) return;
    this.#level = level;
    this.#tell('level', { level });
  }

  /** For the pointer: 'select', 'draw', 'paint', 'curve' or 'cut'. */
  get tool() {
    return this.#tool;
  }

  set tool(tool) {
    this.#tool = tool;
    this.#tell('tool', {});
    this.refresh();
  }

  /** Edges that are dragged snap to what is near. */
  get snap() {
    return this.#snap;
  }

  set snap(snap) {
    this.#snap = snap;
    this.#tell('tool', {});
  }

  /** Rows are high, so that levels are easy to hit. */
  get tall() {
    return this.view.tall;
  }

  set tall(tall) {
    this.view.tall = tall;
    this.reveal(this.playhead, this.cell);
    this.#tell('tool', {});
    this.refresh();
  }

  zoom(factor, ms = this.playhead) {
    this.view.zoom(factor, ms);
    this.moved();
  }

  show(from, to) {
    this.view.zoomTo(from, to);
    this.moved();
  }

  /** The selection, with a tenth of its length on both sides. */
  showSelection() {
    if (!this.#selection) return this.say('Nothing selected');
    const { from, to } = this.#selection;
    return this.show(Math.max(from - (to - from) / 10, 0), to + (to - from) / 10);
  }

  reveal(ms, cell = null) {
    if (this.view.reveal(ms, cell)) this.moved();
  }

  /** The view has changed. */
  moved() {
    this.#tell('view', {});
    this.refresh();
  }

  /** Makes an edit, and says so. */
  edit(splices, label, gesture = null) {
    if (this.readOnly) {
      this.say('Read only: another page writes');
      return false;
    }
    if (splices.length === 0) {
      this.say(`${label}: nothing to change`);
      return false;
    }
    this.history.do(splices, { label, gesture });
    return true;
  }

  /** Splits the events of cells at a time. */
  splitAt(ms, cells = this.cells) {
    const splices = strokes.split(this.history.track, { from: 0, to: this.length, cells }, ms);
    if (this.edit(splices, 'Split')) this.say(`Split at ${formatTime(ms)}`);
  }

  /** Adds a row to the selection, or takes it away; without one, selects the row. */
  toggleRow(cell) {
    const { from, to } = this.#selection ?? { from: 0, to: this.length };
    const cells = this.#selection ? this.cells : [];
    const left = cells.includes(cell) ? cells.filter((one) => one !== cell) : [...cells, cell].sort((a, b) => a - b);
    this.selection = left.length ? { from, to, cells: left } : null;
  }

  /** For screen readers. */
  say(text) {
    // The same text again is said again.
    this.live.textContent = this.live.textContent === text ? `${text}\u00a0` : text;
  }

  /** Says where the playhead is and what is felt there. */
  sayPlace() {
    const { track } = this.history;
    const event = track.eventAt(this.cell, this.playhead);
    const felt = event ? `level ${track.level(this.cell, this.playhead)}, event from `
      + `${formatTime(event.start)} to ${formatTime(event.end)}` : 'silent';
    this.say(`Cell ${cellName(this.cell, track)}, ${formatTime(this.playhead)}, ${felt}`);
  }

  saySelection() {
    const selection = this.#selection;
    if (!selection) return this.say('Nothing selected');
    const { track } = this.history;
    const cells = this.cells.map((cell) => cellName(cell, track));
    const names = cells.length === track.cells && cells.length > 1 ? 'all cells'
      : `cell${cells.length > 1 ? 's' : ''} ${cells.join(', ')}`;
    return this.say(`Selected ${formatTime(selection.from)} to ${formatTime(selection.to)}, ${names}`);
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }
}
