// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Mouse, pen, fingers and wheel on the timeline. A drag shows what it would make, and is one edit when
 * it ends; Escape ends it without.
 *
 * - above the rows: scrubs
 * - a label: selects the row
 * - on nothing: draws. On an event: moves it, its begin, its end or its level
 * - with Shift: selects
 * - wheel: zooms; with Shift, or sideways: pans; with Alt: scrolls the rows
 * - two fingers: zoom and pan; one finger on nothing pans
 */
import * as strokes from './strokes.js';
import { formatTime } from './time.js';

const CURSORS = { label: 'pointer', time: 'col-resize', empty: 'crosshair', begin: 'ew-resize',
  end: 'ew-resize', level: 'ns-resize', event: 'grab' };
/** A pointer that moves less is a click, pixels. */
const SLACK = 3;
/** How near something must be for an edge to snap to it, pixels. */
const SNAP = 6;

export class TimelineGestures {
  #pointers = new Map(); // id → {x, y}
  #drag = null; // {kind, hit, x, y, moved, …}

  /** @param {import('./timeline.js').Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    const { canvas } = timeline;
    const on = (name, act) => canvas.addEventListener(name, act);
    on('wheel', (event) => this.#wheel(event));
    on('pointerdown', (event) => this.#down(event));
    on('pointermove', (event) => this.#move(event));
    on('pointerup', (event) => this.#up(event));
    on('pointercancel', (event) => this.#up(event, true));
    canvas.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || !this.#drag) return;
      this.#end();
      event.stopImmediatePropagation();
      event.preventDefault();
    }, { capture: true });
  }

  get #track() {
    return this.timeline.history.track;
  }

  #place({ clientX, clientY }) {
    const { left, top } = this.timeline.canvas.getBoundingClientRect();
    return { x: clientX - left, y: clientY - top };
  }

  #wheel(event) {
    event.preventDefault();
    const { timeline } = this;
    const unit = [1, 16, timeline.view.height][event.deltaMode];
    const [dx, dy] = [event.deltaX * unit, event.deltaY * unit];
    if (event.altKey) timeline.view.scrollRows(dy);
    else if (event.shiftKey && !event.ctrlKey) timeline.view.pan(dx || dy);
    else {
      // A pinch of a touch pad is a wheel with Ctrl, in small steps.
      if (dx !== 0 && !event.ctrlKey) timeline.view.pan(dx);
      const strength = event.ctrlKey ? 0.01 : 0.002;
      if (dy !== 0) timeline.view.zoom(Math.exp(-dy * strength), timeline.view.ms(this.#place(event).x));
    }
    timeline.moved();
  }

  #down(event) {
    const { timeline } = this;
    const { x, y } = this.#place(event);
    if (event.button > 1 || (event.button === 1 && event.pointerType !== 'mouse')) return;
    timeline.canvas.setPointerCapture(event.pointerId);
    timeline.focus();
    timeline.hasFocus = false;
    this.#pointers.set(event.pointerId, { x, y });
    if (this.#pointers.size === 2) {
      this.#end();
      this.#drag = { kind: 'pinch', ...this.#pair() };
      return;
    }
    if (this.#pointers.size > 2) return;
    const hit = timeline.view.hit(this.#track, x, y);
    if ('cell' in hit) timeline.cell = hit.cell;
    this.#drag = { kind: this.#kindOf(event, hit), hit, x, y, moved: false, at: { x, y },
      source: this.#source(hit), level: timeline.level };
    if (this.#drag.kind === 'time') timeline.seek(hit.ms, { scrubbing: true });
    timeline.refresh();
  }

  #kindOf({ button, shiftKey, pointerType }, { part }) {
    if (button === 1) return 'pan';
    if (part === 'time' || part === 'label') return part;
    if (shiftKey) return 'select';
    if (part === 'empty' && pointerType === 'touch') return 'pan';
    return this.timeline.readOnly ? 'select' : part;
  }

  /** What a drag of an event is about: the selection if the event is in it. */
  #source({ cell, event }) {
    if (!event) return null;
    const { selection } = this.timeline;
    const isIn = selection && (selection.cells?.includes(cell) ?? true)
      && event.start < selection.to && event.end > selection.from;
    return isIn ? selection : { from: event.start, to: event.end, cells: [cell] };
  }

  #pair() {
    const [a, b] = [...this.#pointers.values()];
    return { middle: (a.x + b.x) / 2, apart: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 20) };
  }

  #move(event) {
    const { timeline } = this;
    const { x, y } = this.#place(event);
    const drag = this.#drag;
    if (!drag) {
      timeline.canvas.style.cursor = CURSORS[timeline.view.hit(this.#track, x, y).part];
      return;
    }
    if (this.#pointers.has(event.pointerId)) this.#pointers.set(event.pointerId, { x, y });
    if (drag.kind === 'pinch') {
      const { middle, apart } = this.#pair();
      const ms = timeline.view.ms(drag.middle);
      timeline.view.zoom(apart / drag.apart, ms);
      timeline.view.pan(drag.middle - middle);
      Object.assign(drag, { middle, apart });
      timeline.moved();
      return;
    }
    if (!drag.moved && Math.hypot(x - drag.x, y - drag.y) < SLACK) return;
    drag.moved = true;
    this.#during[drag.kind]?.(drag, { x, y });
    drag.at = { x, y };
    timeline.refresh();
  }

  /** Whole ms within the film, or the playhead, a shot cut or the loop's edge if they are near. */
  #snapped(ms) {
    const { timeline } = this;
    const near = SNAP * timeline.view.scale;
    const { cuts, playhead, loop } = timeline;
    const cut = cuts.find((one) => Math.abs(one - ms) <= near);
    for (const place of [playhead, cut, loop?.from, loop?.to]) {
      if (place !== undefined && Math.abs(place - ms) <= near) return Math.round(place);
    }
    return Math.round(Math.min(Math.max(ms, 0), timeline.length));
  }

  #during = {
    time: (drag, { x }) => this.timeline.seek(this.timeline.view.ms(x), { scrubbing: true }),
    pan: (drag, { x, y }) => {
      this.timeline.view.pan(drag.at.x - x);
      this.timeline.view.scrollRows(drag.at.y - y);
      this.timeline.moved();
    },
    select: (drag, { x, y }) => { this.timeline.selection = this.#between(drag, x, y); },
    empty: (drag, { x }) => {
      const { from, to } = this.#between(drag, x, drag.y);
      this.#show('Draw', { from, to, cells: [drag.hit.cell] },
        [{ cell: drag.hit.cell, start: from, end: to, level: drag.level }],
        () => strokes.draw(this.#track, { from, to, cells: [drag.hit.cell] }, drag.level));
    },
    event: (drag, { x, y }) => {
      const { view } = this.timeline;
      const { source } = drag;
      const from = this.#snapped(source.from + (x - drag.x) * view.scale);
      const { columns } = this.#track;
      const to = view.cellAt(y);
      const by = { ms: from - source.from,
        rows: Math.floor(to / columns) - Math.floor(drag.hit.cell / columns),
        columns: to % columns - drag.hit.cell % columns };
      const done = strokes.clampedMove(this.#track, source, by);
      this.#show('Move', strokes.movedSelection(this.#track, source, by),
        this.#track.spans(source).map(({ cell, start, end, level }) =>
          ({ cell: cell + done.rows * columns + done.columns, start: start + done.ms, end: end + done.ms,
            level })),
        () => strokes.move(this.#track, source, by));
    },
    begin: (drag, { x }) => {
      const { source } = drag;
      const from = this.#snapped(source.from + (x - drag.x) * this.timeline.view.scale);
      this.#stretch(source, { from: Math.min(from, source.to - 1), to: source.to });
    },
    end: (drag, { x }) => {
      const { source } = drag;
      const to = this.#snapped(source.to + (x - drag.x) * this.timeline.view.scale);
      this.#stretch(source, { from: source.from, to: Math.max(to, source.from + 1) });
    },
    level: (drag, { y }) => {
      const { source, hit } = drag;
      const by = Math.round((drag.y - y) / this.timeline.view.barRoom * 100);
      const before = this.#track.level(hit.cell, Math.floor(hit.ms));
      this.timeline.level = before + by;
      this.#show('Level', source, this.#track.spans(source).map((span) =>
        ({ ...span, level: Math.min(Math.max(span.level + by, 1), 100) })),
      () => strokes.addLevel(this.#track, source, by));
    },
  };

  #stretch(source, to) {
    const factor = (to.to - to.from) / (source.to - source.from);
    const scaled = (ms) => to.from + (ms - source.from) * factor;
    const spans = this.#track.spans(source).map(({ cell, start, end, level }) =>
      ({ cell, start: scaled(start), end: scaled(end), level }));
    this.#show('Stretch', { ...source, ...to }, spans, () => strokes.stretch(this.#track, source, to));
  }

  /** The selection between where the drag began and a place. */
  #between(drag, x, y) {
    const { view } = this.timeline;
    const [a, b] = [this.#snapped(drag.hit.ms), this.#snapped(view.ms(x))];
    const [c, d] = [drag.hit.cell, view.cellAt(y)];
    const [top, bottom] = [Math.min(c, d), Math.max(c, d)];
    return { from: Math.min(a, b), to: Math.max(a, b, Math.min(a, b) + 1),
      cells: Array.from({ length: bottom - top + 1 }, (_, i) => top + i) };
  }

  /** Shows what the drag would make; `stroke` makes it. */
  #show(label, selection, spans, stroke) {
    Object.assign(this.#drag, { label, selection, stroke });
    this.timeline.ghost = spans;
  }

  #up(event, isCancelled = false) {
    this.#pointers.delete(event.pointerId);
    const drag = this.#drag;
    if (!drag || (drag.kind === 'pinch' && this.#pointers.size > 0)) return;
    this.#end();
    const { timeline } = this;
    if (isCancelled || drag.kind === 'pinch' || drag.kind === 'pan') return;
    if (drag.kind === 'time') timeline.seek(timeline.view.ms(this.#place(event).x));
    else if (!drag.moved) this.#click(drag.hit);
    else if (drag.kind === 'select') timeline.saySelection();
    else if (drag.stroke && timeline.edit(drag.stroke(), drag.label)) {
      timeline.selection = drag.selection;
      timeline.say(`${drag.label}: ${formatTime(drag.selection.from)} to ${formatTime(drag.selection.to)}`);
    }
  }

  #click({ part, cell, event, ms }) {
    const { timeline } = this;
    if (part === 'label') {
      const { from, to } = timeline.selection ?? { from: 0, to: timeline.length };
      timeline.selection = { from, to, cells: [cell] };
    } else if (event) timeline.selection = { from: event.start, to: event.end, cells: [cell] };
    else {
      timeline.selection = null;
      timeline.seek(ms);
    }
    timeline.saySelection();
  }

  #end() {
    this.#drag = null;
    this.timeline.ghost = [];
    this.timeline.refresh();
  }
}
