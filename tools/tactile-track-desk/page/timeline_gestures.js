// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Mouse, pen, fingers and wheel on the timeline. A drag shows what it would make, and is one edit when
 * it ends; Escape ends it without.
 *
 * - above the rows: scrubs
 * - labels: select rows; with Shift up to there, with Ctrl one more or one less
 * - the tool `draw`: on nothing, draws; on an event, moves it, its begin, its end or its level
 * - `select`: as `draw`, but on nothing selects, as each tool does with Shift
 * - `paint`: the level follows the pointer. `cut`: a click splits the event
 * - `curve`: a drag puts or moves a point of the event's curve, a click with Ctrl takes it away
 * - wheel: scrolls the rows, or pans where all are in view; with Shift, or sideways: pans; with Ctrl:
 *   zooms around the pointer
 * - two fingers: zoom and pan; one finger on nothing pans
 */
import { pointsOf, spansOf, withPoint } from './curves.js';
import * as strokes from './strokes.js';
import { firstAfter, formatTime } from './time.js';

const CURSORS = { paint: 'crosshair', curve: 'crosshair', cut: 'col-resize', select: 'default', label: 'pointer',
  time: 'col-resize', empty: 'crosshair', begin: 'ew-resize', end: 'ew-resize', level: 'ns-resize', event: 'grab' };
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
    if (event.ctrlKey) {
      // A pinch of a touch pad is a wheel with Ctrl, in steps of a few pixels; a notch has a hundred.
      const by = Math.min(Math.max(-dy * 0.01, -0.25), 0.25);
      timeline.view.zoom(Math.exp(by), timeline.view.ms(this.#place(event).x));
    } else if (event.shiftKey || !timeline.view.hasHiddenRows) timeline.view.pan(dx || dy);
    else {
      timeline.view.pan(dx);
      timeline.view.scrollRows(dy);
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
      source: this.#source(hit), level: timeline.level, more: event.ctrlKey || event.metaKey,
      extend: event.shiftKey };
    if (this.#drag.kind === 'time') timeline.seek(hit.ms, { scrubbing: true });
    timeline.refresh();
  }

  #kindOf({ button, shiftKey, pointerType }, { part }) {
    if (button === 1) return 'pan';
    if (part === 'time' || part === 'label') return part;
    if (shiftKey) return 'select';
    const { tool, readOnly } = this.timeline;
    if (tool === 'curve' && part !== 'empty' && !readOnly) return tool;
    if (tool === 'cut' || (tool === 'paint' && !readOnly)) return tool;
    if (part === 'empty' && pointerType === 'touch') return 'pan';
    return readOnly || (tool === 'select' && part === 'empty') ? 'select' : part;
  }

  /** What a drag of an event is about: the selection if the whole event is in it. */
  #source({ cell, event }) {
    if (!event) return null;
    const { selection } = this.timeline;
    const isIn = selection && (selection.cells?.includes(cell) ?? true)
      && event.start >= selection.from && event.end <= selection.to;
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
      const hit = timeline.view.hit(this.#track, x, y);
      timeline.canvas.style.cursor = CURSORS[this.#kindOf({ button: 0 }, hit)];
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

  /** Begins and ends of events around a time, but of those that are dragged. */
  #edges(ms, near) {
    const source = this.#drag?.source;
    const isDragged = (cell, { start, end }) => source && (source.cells?.includes(cell) ?? true)
      && start < source.to && end > source.from;
    return [...this.#track.silence.keys()].flatMap((cell) =>
      [...this.#track.events(cell, ms - near, ms + near)].filter((event) => !isDragged(cell, event))
        .flatMap(({ start, end }) => [start, end]));
  }

  /** The nearest of playhead, shot cuts, impacts, edges of events and the loop's, if one is near. */
  #near(ms) {
    const { snap, view, cuts, impacts, playhead, loop } = this.timeline;
    if (!snap) return undefined;
    const near = SNAP * view.scale;
    const places = [playhead, nearest(cuts, ms), nearest(impacts, ms), loop?.from, loop?.to, ...this.#edges(ms, near)]
      .filter((place) => place !== undefined && Math.abs(place - ms) <= near);
    return places.length ? Math.round(nearest(places.sort((a, b) => a - b), ms)) : undefined;
  }

  /** Whole ms within the film, or what is near. */
  #snapped(ms) {
    return this.#near(ms) ?? Math.round(Math.min(Math.max(ms, 0), this.timeline.length));
  }

  #during = {
    time: (drag, { x }) => this.timeline.seek(this.timeline.view.ms(x), { scrubbing: true }),
    pan: (drag, { x, y }) => {
      this.timeline.view.pan(drag.at.x - x);
      this.timeline.view.scrollRows(drag.at.y - y);
      this.timeline.moved();
    },
    label: (drag, { y }) => {
      const { from, to } = this.timeline.selection ?? { from: 0, to: this.timeline.length };
      this.timeline.selection = { from, to, cells: rows(drag.hit.cell, this.timeline.view.cellAt(y)) };
    },
    paint: (drag, { x, y }) => {
      const { view, frame } = this.timeline;
      const { cell } = drag.hit;
      drag.frames ??= new Map();
      paintFrames(drag.frames, [drag.at, { x, y }].map((at) =>
        ({ frame: Math.floor(Math.max(view.ms(at.x), 0) / frame), level: view.levelAt(cell, at.y) })));
      const spans = [...drag.frames].sort(([a], [b]) => a - b).map(([index, level]) =>
        ({ cell, start: Math.round(index * frame), end: Math.round((index + 1) * frame), level }));
      this.#show('Paint', { from: spans[0].start, to: spans.at(-1).end, cells: [cell] }, spans,
        () => strokes.paint(this.#track, spans));
    },
    curve: (drag, { x, y }) => {
      const { view, frame } = this.timeline;
      const { cell, event } = drag.hit;
      drag.points ??= this.#pointsWithout(drag);
      const ms = Math.min(Math.max(this.#snapped(view.ms(x)), event.start), event.end);
      const points = withPoint(drag.points, ms, Math.max(view.levelAt(cell, y), 1), SNAP * view.scale);
      this.timeline.points = points;
      const spans = spansOf(cell, points, frame);
      this.#show('Curve', { from: event.start, to: event.end, cells: [cell] }, spans,
        () => strokes.paint(this.#track, spans));
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
      // The begin snaps, else the end.
      const dragged = source.from + (x - drag.x) * view.scale;
      const end = this.#near(dragged + source.to - source.from);
      const from = this.#near(dragged) ?? (end ? end - source.to + source.from : this.#snapped(dragged));
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

  /** The points of an event, without the one that a drag has begun at. */
  #pointsWithout({ hit: { event, ms } }) {
    const points = pointsOf(this.#track, event);
    const near = SNAP * this.timeline.view.scale;
    return points.filter((point, i) => i === 0 || i === points.length - 1 || Math.abs(point.ms - ms) > near);
  }

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
    return { from: Math.min(a, b), to: Math.max(a, b, Math.min(a, b) + 1),
      cells: rows(drag.hit.cell, view.cellAt(y)) };
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
    else if (!drag.moved) this.#click(drag);
    else if (drag.kind === 'select' || drag.kind === 'label') timeline.saySelection();
    else if (drag.stroke && timeline.edit(drag.stroke(), drag.label)) {
      timeline.selection = drag.selection;
      timeline.say(`${drag.label}: ${formatTime(drag.selection.from)} to ${formatTime(drag.selection.to)}`);
    }
  }

  #click({ kind, hit: { part, cell, event, ms }, more, extend }) {
    const { timeline } = this;
    if (part === 'label') {
      if (more) timeline.toggleRow(cell);
      else {
        const { from, to, cells } = timeline.selection ?? { from: 0, to: timeline.length };
        timeline.selection = { from, to, cells: rows(extend && cells ? cells[0] : cell, cell) };
      }
    } else if (kind === 'curve' && more) {
      const spans = spansOf(cell, this.#pointsWithout({ hit: { event, ms } }), timeline.frame);
      timeline.edit(strokes.paint(this.#track, spans), 'Curve');
      return;
    } else if (kind === 'cut' && event) {
      timeline.splitAt(this.#snapped(ms), [cell]);
      return;
    } else if (event) timeline.selection = { from: event.start, to: event.end, cells: [cell] };
    else {
      timeline.selection = null;
      timeline.seek(ms);
    }
    timeline.saySelection();
  }

  #end() {
    this.#drag = null;
    this.timeline.points = null;
    this.timeline.ghost = [];
    this.timeline.refresh();
  }
}

/** The cells from one row to another. */
function rows(a, b) {
  const top = Math.min(a, b);
  return Array.from({ length: Math.abs(a - b) + 1 }, (_, i) => top + i);
}

/** The levels of all frames from one to another, in a straight line. */
function paintFrames(frames, [a, b]) {
  const count = Math.abs(b.frame - a.frame);
  for (let i = 0; i <= count; i++) {
    frames.set(a.frame + Math.sign(b.frame - a.frame) * i,
      count ? Math.round(a.level + (b.level - a.level) * i / count) : b.level);
  }
}

/** Of times in order. */
function nearest(times, ms) {
  const after = firstAfter(times, ms);
  const [before, next] = [times[after - 1], times[after]];
  return before === undefined || next - ms < ms - before ? next : before;
}
