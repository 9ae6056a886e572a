// SPDX-License-Identifier: LGPL-2.1-or-later
/** Draws the timeline on a canvas. Colors are CSS variables, for light, dark and forced colors. */
import { firstAfter, formatTime } from './time.js';
import { cellName } from './track.js';
import { pointsOf } from './curves.js';
import { TimelineBars } from './timeline_bars.js';
import { GUTTER, RULER, rulerStep } from './timeline_view.js';

/** Of the small grid beside a row, pixels. */
const PLACE = 15;

/** Where the page's style sheet sets none. */
const COLORS = { background: 'Canvas', row: 'Canvas', line: 'GrayText', text: 'CanvasText',
  event: 'CanvasText', draft: 'GrayText', selection: 'Highlight', playhead: 'Highlight',
  warning: 'CanvasText', cut: 'GrayText', wave: 'GrayText' };

export class TimelinePainter {
  #bars = new TimelineBars();

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d', { alpha: false });
    this.readColors();
  }

  readColors() {
    const style = getComputedStyle(this.canvas);
    const forced = matchMedia('(forced-colors: active)').matches;
    this.colors = {};
    for (const [name, color] of Object.entries(COLORS)) {
      this.colors[name] = (!forced && style.getPropertyValue(`--tl-${name}`).trim()) || color;
    }
    this.font = `12px ${style.fontFamily || 'sans-serif'}`;
  }

  /** Of the view, in device pixels. */
  resize(view, ratio) {
    this.ratio = ratio;
    const width = Math.max(Math.round(view.width * ratio), 1);
    const height = Math.max(Math.round(view.height * ratio), 1);
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }

  /** @param {import('./timeline.js').Timeline} timeline */
  paint(timeline) {
    const { context, colors, ratio } = this;
    const { view } = timeline;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colors.background;
    context.fillRect(0, 0, view.width, view.height);
    context.save();
    context.beginPath();
    context.rect(GUTTER, 0, view.span, view.height);
    context.clip();
    this.#rows(view);
    if (view.hasStrip) this.#strip(timeline);
    if (view.hasWave) this.#wave(timeline);
    if (view.hasWave) this.#impacts(timeline);
    this.#lines(view, timeline.cuts, colors.cut);
    context.save();
    context.beginPath();
    context.rect(GUTTER, view.rowsTop, view.span, view.height - view.rowsTop);
    context.clip();
    const tracks = [[timeline.history.track, colors.event]];
    if (timeline.draft) tracks.unshift([timeline.draft, colors.draft]);
    this.#bars.draw(context, view, ratio, tracks);
    this.#warnings(view, timeline.warnings);
    this.#selection(view, timeline);
    this.#ghost(view, timeline.ghost);
    if (timeline.tool === 'curve') this.#curves(view, timeline);
    context.restore();
    this.#ruler(timeline);
    context.restore();
    this.#labels(view, timeline);
    this.#playhead(timeline);
  }

  #rows(view) {
    const { context, colors } = this;
    const [first, last] = view.visibleCells;
    for (let cell = first; cell < last; cell++) {
      context.fillStyle = colors.row;
      context.fillRect(GUTTER, Math.round(view.top(cell)), view.span, Math.round(view.rowHeight) - 1);
    }
  }

  #lines(view, times, color) {
    const { context } = this;
    context.fillStyle = color;
    let last = -9;
    for (let i = firstAfter(times, view.from); i < times.length && times[i] < view.to; i++) {
      const x = Math.round(view.x(times[i]));
      if (x < last + 3) continue; // cuts of a flashing film are no area
      context.fillRect(x, RULER, 1, view.height);
      last = x;
    }
  }

  #strip({ view, strip, thumbnail }) {
    const { context } = this;
    const width = 46 * strip.width / strip.height;
    // Each is as wide as several may be in time: as many as fit, evenly.
    const every = Math.max(Math.ceil(width * view.scale / strip.interval), 1);
    const first = Math.max(Math.floor(view.from / strip.interval / every) * every, 0);
    for (let index = first; index < strip.total && index * strip.interval < view.to; index += every) {
      const picture = thumbnail(index);
      if (picture) context.drawImage(picture, view.x(index * strip.interval), view.stripTop + 1, width, 46);
    }
  }

  #wave({ view, peaks }) {
    const { context, colors, ratio } = this;
    context.fillStyle = colors.wave;
    const middle = view.waveTop + 18;
    const count = Math.ceil(view.span * ratio);
    for (let x = 0; x < count; x++) {
      const first = Math.floor((view.from + x / ratio * view.scale) / 10);
      const last = Math.max(Math.floor((view.from + (x + 1) / ratio * view.scale) / 10), first + 1);
      // Of hours in view, some of them are enough.
      const every = Math.max(Math.floor((last - first) / 32), 1);
      let peak = 0;
      for (let i = first; i < last && i < peaks.length; i += every) if (peaks[i] > peak) peak = peaks[i];
      if (peak > 0) {
        const half = Math.max(peak / 255 * 16, 0.5);
        context.fillRect(GUTTER + x / ratio, middle - half, 1 / ratio, 2 * half);
      }
    }
  }

  /** A tick at the bottom of the waveform for each impact. */
  #impacts({ view, impacts }) {
    const { context, colors } = this;
    context.fillStyle = colors.text;
    for (let i = firstAfter(impacts, view.from); i < impacts.length && impacts[i] < view.to; i++)
      context.fillRect(Math.round(view.x(impacts[i])), view.rowsTop - 9, 2, 8);
  }

  /** A line below the events where a cell breaks a limit, above all rows where several do. */
  #warnings(view, warnings) {
    const { context, colors } = this;
    context.fillStyle = colors.warning;
    const [first, last] = view.visibleCells;
    const drawn = new Map();
    for (const { cell, start, end } of warnings) {
      if (start >= view.to) break;
      if (end <= view.from || (cell >= 0 && (cell < first || cell >= last))) continue;
      const from = Math.max(view.x(start), drawn.get(cell) ?? GUTTER);
      const to = Math.min(Math.max(view.x(end), from + 2), view.width);
      if (to <= (drawn.get(cell) ?? 0)) continue;
      drawn.set(cell, to);
      const y = cell < 0 ? view.rowsTop : Math.round(view.top(cell) + view.rowHeight) - 5;
      context.fillRect(from, y, to - from, 3);
    }
  }

  #selection(view, { selection, history: { track } }) {
    if (!selection) return;
    const { context, colors } = this;
    const x = view.x(selection.from);
    const width = Math.max((selection.to - selection.from) / view.scale, 1);
    for (const cell of selection.cells ?? track.silence.keys()) {
      const [y, height] = [Math.round(view.top(cell)) + 0.5, Math.round(view.rowHeight) - 2];
      context.globalAlpha = 0.18;
      context.fillStyle = colors.selection;
      context.fillRect(x, y, width, height);
      context.globalAlpha = 1;
      context.strokeStyle = colors.selection;
      context.lineWidth = 1.5;
      context.strokeRect(x, y, width, height);
    }
  }

  /** What a gesture would make. */
  #ghost(view, spans) {
    const { context, colors } = this;
    context.strokeStyle = colors.text;
    context.lineWidth = 1.5;
    context.setLineDash([4, 3]);
    for (const { cell, start, end, level } of spans) {
      const [y, height] = view.bar(cell, Math.max(level, 1));
      context.strokeRect(view.x(start), y, Math.max((end - start) / view.scale, 1), height);
    }
    context.setLineDash([]);
  }

  /** The points of the events in view, if they are not too many. */
  #curves(view, { history: { track }, ghost, points, held }) {
    const [first, last] = view.visibleCells;
    for (let cell = first; cell < last; cell++) {
      const events = [...track.events(cell, Math.floor(view.from), Math.ceil(view.to))];
      if (events.length > view.span / 30) continue;
      for (const event of events) {
        const isHeld = held?.cell === cell && held.points[0].ms === event.start;
        this.#curve(view, cell, isHeld ? held.points : pointsOf(track, event));
      }
    }
    if (held) this.#heldPoint(view, held);
    if (points) this.#curve(view, ghost[0].cell, points);
  }

  #curve(view, cell, points) {
    const { context, colors } = this;
    const places = points.map(({ ms, level }) => [view.x(ms), view.bar(cell, level)[0]]);
    context.strokeStyle = context.fillStyle = colors.text;
    context.lineWidth = 1;
    context.beginPath();
    for (const [x, y] of places) context.lineTo(x, y);
    context.stroke();
    for (const [x, y] of places) context.fillRect(x - 3, y - 3, 6, 6);
  }

  #heldPoint(view, { cell, points, index }) {
    const { context, colors } = this;
    const { ms, level } = points[index];
    context.strokeStyle = colors.selection;
    context.lineWidth = 2;
    context.strokeRect(view.x(ms) - 6, view.bar(cell, level)[0] - 6, 12, 12);
  }

  #ruler({ view, history: { track }, loop }) {
    const { context, colors } = this;
    context.fillStyle = colors.background;
    context.fillRect(GUTTER, 0, view.span, RULER - 1);
    if (loop) {
      context.fillStyle = colors.selection;
      context.fillRect(view.x(loop.from), RULER - 5, Math.max((loop.to - loop.from) / view.scale, 2), 4);
    }
    context.fillStyle = colors.text;
    context.font = this.font;
    context.textBaseline = 'alphabetic';
    const step = rulerStep(view.scale);
    for (let ms = Math.ceil(view.from / step) * step; ms < view.to; ms += step) {
      const x = Math.round(view.x(ms));
      context.fillRect(x, RULER - 7, 1, 6);
      const label = formatTime(ms);
      context.fillText(step < 1000 ? label : label.slice(0, -4), x + 3, 14);
    }
    // Notes.
    const [first, last] = track.range(Math.floor(view.from), Math.ceil(view.to));
    let drawn = -9;
    for (let i = first; i < last; i++) {
      const { start, notes } = track.cues[i];
      const x = view.x(start);
      if (!notes?.length || x < drawn + 6) continue;
      drawn = x;
      context.beginPath();
      context.moveTo(x, RULER - 1);
      context.lineTo(x - 4, RULER - 8);
      context.lineTo(x + 4, RULER - 8);
      context.fill();
    }
  }

  #labels(view, { cell: current, hasFocus, history: { track } }) {
    const { context, colors } = this;
    context.font = this.font;
    context.textBaseline = 'middle';
    const [first, last] = view.visibleCells;
    context.save();
    context.beginPath();
    context.rect(0, view.rowsTop, GUTTER, view.height - view.rowsTop);
    context.clip();
    for (let cell = first; cell < last; cell++) {
      const [y, height] = [view.top(cell), view.rowHeight];
      if (cell === current) {
        context.fillStyle = colors.selection;
        context.fillRect(0, y, 4, height - 1);
      }
      context.fillStyle = colors.text;
      context.font = cell === current ? `bold ${this.font}` : this.font;
      context.fillText(cellName(cell, track), 9, y + height / 2);
      this.#cellPlace(cell, track, y + height / 2);
    }
    context.restore();
    context.textBaseline = 'alphabetic';
    if (hasFocus) {
      context.strokeStyle = colors.selection;
      context.lineWidth = 2;
      context.strokeRect(1, Math.max(view.top(current), view.rowsTop) + 1, view.width - 2, view.rowHeight - 3);
    }
  }

  /** A small grid that shows where a row's cell is; of a large one, its outline. */
  #cellPlace(cell, { rows, columns }, middle) {
    const { context, colors } = this;
    const side = Math.min(Math.floor(PLACE / Math.max(rows, columns)), 8);
    const [wide, high] = side >= 3 ? [side * columns, side * rows] : [PLACE, PLACE];
    const [stepX, stepY] = [wide / columns, high / rows];
    const [left, top] = [Math.round(GUTTER - 8 - wide), Math.round(middle - high / 2)];
    const gap = side >= 3 ? 1 : 0;
    context.fillStyle = colors.line;
    for (let i = 0; i < (gap ? rows * columns : 1); i++) {
      if (gap) context.fillRect(left + i % columns * side, top + Math.floor(i / columns) * side, side - gap, side - gap);
      else context.fillRect(left, top, wide, high);
    }
    context.fillStyle = colors.event;
    context.fillRect(left + cell % columns * stepX, top + Math.floor(cell / columns) * stepY,
      Math.max(stepX - gap, 2), Math.max(stepY - gap, 2));
  }

  #playhead({ view, playhead }) {
    const { context, colors } = this;
    const x = view.x(playhead);
    if (x < GUTTER - 1 || x > view.width) return;
    context.fillStyle = colors.playhead;
    context.fillRect(Math.round(x), 0, 2, view.height);
    context.beginPath();
    context.moveTo(x - 5, 0);
    context.lineTo(x + 7, 0);
    context.lineTo(x + 1, 9);
    context.fill();
  }
}
