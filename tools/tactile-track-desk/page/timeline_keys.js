// SPDX-License-Identifier: LGPL-2.1-or-later
/** The keys of the timeline. What they do not use is the page's. */
import { PointKeys } from './point_keys.js';
import * as strokes from './strokes.js';
import { cellName, extent } from './track.js';
import { formatTime } from './time.js';

/** What they do, for the help. */
export const KEYS = [
  { keys: ['Left', 'Right'], does: 'A frame back, forward' },
  { keys: ['Ctrl+Left', 'Ctrl+Right'], does: 'To where an event of the cell begins or ends' },
  { keys: ['Up', 'Down'], does: 'To another cell' },
  { keys: ['Home', 'End'], does: 'To the begin, to the end' },
  { keys: ['Page Up', 'Page Down'], does: 'A screen back, forward' },
  { keys: ['C', 'Shift+C'], does: 'To the next, the last shot cut' },
  { keys: ['U', 'Shift+U'], does: 'To the next, the last impact of the sound' },
  { keys: ['N', 'Shift+N'], does: 'To the next, the last warning' },
  { keys: ['Shift + one of the first five'], does: 'Selects up to there' },
  { keys: ['I', 'O'], does: 'The selection begins, ends at the playhead' },
  { keys: ['Ctrl+A', 'Escape'], does: 'Selects all, nothing' },
  { keys: ['Ctrl+Enter'], does: 'Adds the row to the selection, or takes it away' },
  { keys: ['Enter'],
    does: 'Draws the selection; without one, selects the event at the playhead or draws one' },
  { keys: ['Delete', 'Backspace'], does: 'Silences the selection or the event' },
  { keys: ['+', '-'], does: 'Level of the selection and of what is drawn: 5 % more, less' },
  { keys: ['Alt+Left', 'Alt+Right'], does: 'Moves the selection by a frame' },
  { keys: ['Alt+Up', 'Alt+Down'], does: 'Moves the selection to another cell' },
  { keys: ['Alt+Shift+Left', 'Alt+Shift+Right'], does: 'Lets the selection last a frame less, more' },
  { keys: ['S'], does: 'Splits the event at the playhead' },
  { keys: ['M'], does: 'Merges the events of the selection' },
  { keys: ['F', 'Shift+F'], does: 'Fades the selection out, in' },
  { keys: ['Ctrl+C', 'Ctrl+X', 'Ctrl+V'], does: 'Copies, cuts, pastes at the playhead and cell' },
  { keys: ['Ctrl+D'], does: 'Repeats the selection after itself' },
  { keys: ['Ctrl+Z', 'Ctrl+Shift+Z', 'Ctrl+Y'], does: 'Undoes, does again' },
  { keys: ['L'], does: 'Loops the selection, or ends that' },
  { keys: ['Z', 'Shift+Z'], does: 'Zooms in, out' },
  { keys: ['W', 'Shift+W'], does: 'Zooms to the whole film, to the selection' },
  { keys: ['Y'], does: 'Rows are high, or all in view' },
  { keys: ['Q', 'D', 'B', 'H', 'X'], does: 'The pointer selects, draws, paints, bends levels, cuts' },
  { keys: ['Shift+S'], does: 'Edges snap to what is near, or not' },
];

/** How long an event is that is drawn without a selection, ms. */
const NEW_EVENT = 200;

export class TimelineKeys {
  #points;
  #anchor = null; // {ms, cell} where a selection with Shift began
  #gesture = null; // of a key that is held down
  #clip = null;
  #moved = null; // {from, by, to}: selections of the last edit, if that was a move by keys

  /** @param {import('./timeline.js').Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    this.#points = new PointKeys(timeline);
    timeline.history.addEventListener('change', () => { this.#moved = null; });
    timeline.canvas.addEventListener('keydown', (event) => {
      timeline.hasFocus = true; // by keys
      if (!event.repeat) this.#gesture = {};
      if (!this.#press(event)) return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  get #track() {
    return this.timeline.history.track;
  }

  /** @returns {boolean} whether the key is one of ours */
  #press({ key, shiftKey, altKey, ctrlKey, metaKey }) {
    const name = key.length === 1 ? key.toLowerCase() : key;
    const command = ctrlKey || metaKey;
    if (command && altKey) return false; // AltGr
    const shifted = shiftKey && name.length > 1; // + has Shift on some keyboards
    if (!shifted && this.#points.press(name, { command, alt: altKey }, this.#gesture)) return true;
    const act = (command ? this.#commands : altKey ? this.#moves : this.#plain)[name];
    if (!act) return false;
    act.call(this, shiftKey);
    return true;
  }

  #plain = {
    ArrowLeft: (shift) => this.#step(-1, shift),
    ArrowRight: (shift) => this.#step(1, shift),
    ArrowUp: (shift) => this.#go(this.timeline.playhead, this.timeline.cell - 1, shift),
    ArrowDown: (shift) => this.#go(this.timeline.playhead, this.timeline.cell + 1, shift),
    Home: (shift) => this.#go(0, this.timeline.cell, shift),
    End: (shift) => this.#go(this.timeline.length, this.timeline.cell, shift),
    PageUp: (shift) => this.#page(-1, shift),
    PageDown: (shift) => this.#page(1, shift),
    Enter: () => this.#draw(),
    Delete: () => this.#erase('Delete'),
    Backspace: () => this.#erase('Delete'),
    Escape: () => this.#select(null),
    '+': () => this.#addLevel(5),
    '=': () => this.#addLevel(5),
    '-': () => this.#addLevel(-5),
    _: () => this.#addLevel(-5),
    s: (shift) => (shift ? this.#snap() : this.timeline.splitAt(this.timeline.playhead)),
    m: () => this.#change('Merge', strokes.merge),
    f: (shift) => this.#change(shift ? 'Fade in' : 'Fade out', (track, selection) =>
      (shift ? strokes.fade(track, selection, 0, 100) : strokes.fade(track, selection, 100, 0))),
    i: () => this.#edge('from'),
    o: () => this.#edge('to'),
    l: () => this.#loop(),
    c: (shift) => this.#to(this.timeline.cuts, 'shot cut', shift),
    u: (shift) => this.#to(this.timeline.impacts, 'impact', shift),
    n: (shift) => this.#warning(shift),
    z: (shift) => this.timeline.zoom(shift ? 1 / 1.5 : 1.5),
    w: (shift) => (shift ? this.timeline.showSelection() : this.timeline.show(0, this.timeline.length)),
    y: () => this.#tall(),
    q: () => this.#tool('select'),
    d: () => this.#tool('draw'),
    b: () => this.#tool('paint'),
    x: () => this.#tool('cut'),
    h: () => this.#tool('curve'),
  };

  #moves = {
    ArrowLeft: (shift) => (shift ? this.#stretch(-1) : this.#move({ ms: -this.timeline.frame })),
    ArrowRight: (shift) => (shift ? this.#stretch(1) : this.#move({ ms: this.timeline.frame })),
    ArrowUp: () => this.#moveCells(-1),
    ArrowDown: () => this.#moveCells(1),
  };

  #commands = {
    ArrowLeft: (shift) => this.#edgeOfEvent(false, shift),
    ArrowRight: (shift) => this.#edgeOfEvent(true, shift),
    a: () => this.#select({ from: 0, to: this.timeline.length }),
    Enter: () => {
      this.timeline.toggleRow(this.timeline.cell);
      this.timeline.saySelection();
    },
    c: () => this.#copy(),
    x: () => {
      if (this.#copy()) this.#erase('Cut');
    },
    v: () => this.#paste(),
    d: () => this.#repeat(),
    z: (shift) => this.#undo(shift),
    y: () => this.#undo(true),
  };

  /** Moves playhead and cell; with Shift, selects from where that began. */
  #go(ms, cell, shift) {
    const { timeline } = this;
    const to = Math.min(Math.max(cell, 0), this.#track.cells - 1);
    if (shift) this.#anchor ??= { ms: timeline.playhead, cell: timeline.cell };
    else this.#anchor = null;
    timeline.cell = to;
    if (Math.round(ms) !== timeline.playhead) timeline.seek(ms);
    timeline.reveal(timeline.playhead, to);
    timeline.refresh();
    if (!shift) return timeline.sayPlace();
    const { ms: first, cell: firstCell } = this.#anchor;
    const [from, until] = [Math.min(first, timeline.playhead), Math.max(first, timeline.playhead)];
    const [top, bottom] = [Math.min(firstCell, to), Math.max(firstCell, to)];
    timeline.selection = from < until
      ? { from, to: until, cells: Array.from({ length: bottom - top + 1 }, (_, i) => top + i) } : null;
    return timeline.saySelection();
  }

  /** A frame begins at a whole ms at or after its time. */
  #step(frames, shift) {
    const { playhead, frame, cell } = this.timeline;
    const index = Math.floor(playhead / frame + 1e-6);
    const begin = Math.ceil(index * frame - 1e-6);
    const to = frames < 0 && playhead > begin ? index : index + frames;
    this.#go(Math.ceil(to * frame - 1e-6), cell, shift);
  }

  #page(pages, shift) {
    const { view, playhead, cell } = this.timeline;
    this.#go(playhead + 0.9 * pages * (view.to - view.from), cell, shift);
  }

  #edgeOfEvent(forward, shift) {
    const { cell, playhead, length } = this.timeline;
    this.#go(this.#track.nextEdge(cell, playhead, forward) ?? (forward ? length : 0), cell, shift);
  }

  #to(times, name, back) {
    const { playhead, cell } = this.timeline;
    const to = back ? times.findLast((ms) => ms < playhead) : times.find((ms) => ms > playhead);
    if (to === undefined) this.timeline.say(`No ${name} ${back ? 'before' : 'after'}`);
    else this.#go(to, cell, false);
  }

  #warning(back) {
    const { warnings, playhead, cell } = this.timeline;
    const found = back ? warnings.findLast(({ start }) => start < playhead)
      : warnings.find(({ start }) => start > playhead);
    if (!found) return this.timeline.say(back ? 'No warning before' : 'No warning after');
    this.#go(found.start, found.cell >= 0 ? found.cell : cell, false);
    this.timeline.selection = { from: found.start, to: found.end,
      ...(found.cell >= 0 && { cells: [found.cell] }) };
    return this.timeline.say(`${found.text}, ${formatTime(found.start)} to ${formatTime(found.end)}`);
  }

  #select(selection) {
    this.#anchor = null;
    this.timeline.selection = selection;
    this.timeline.saySelection();
  }

  #edge(which) {
    const { playhead, selection, cells, frame } = this.timeline;
    const one = Math.ceil(frame);
    const { from, to } = selection ?? { from: playhead, to: playhead + one };
    this.#select(which === 'from' ? { from: playhead, to: to > playhead ? to : playhead + one, cells }
      : { from: from < playhead ? from : Math.max(playhead - one, 0), to: Math.max(playhead, 1), cells });
  }

  #loop() {
    const { selection, loop } = this.timeline;
    this.timeline.loop = loop || !selection ? null : { from: selection.from, to: selection.to };
    const off = selection || loop ? 'Loop off' : 'Select what to loop';
    this.timeline.say(this.timeline.loop ? 'Loop on' : off);
  }

  /** The selection, else the event at the playhead; says so if there is none. */
  #chosen() {
    const { selection, cell, playhead } = this.timeline;
    if (selection) return selection;
    const event = this.#track.eventAt(cell, playhead);
    if (event) return { from: event.start, to: event.end, cells: [cell] };
    this.timeline.say('Nothing is selected, and nothing is felt at the playhead');
    return null;
  }

  /** Makes an edit of what is chosen, and selects `after`. */
  #change(label, stroke, after = (selection) => selection) {
    const selection = this.#chosen();
    if (!selection) return;
    const next = after(selection);
    if (!this.timeline.edit(stroke(this.#track, selection), label, this.#gesture)) return;
    this.timeline.selection = next;
    this.timeline.say(`${label}. Selected ${formatTime(next.from)} to ${formatTime(next.to)}`);
  }

  #erase(label) {
    this.#change(label, strokes.erase);
  }

  #draw() {
    const { timeline } = this;
    const { selection, cell, playhead, level } = timeline;
    const event = this.#track.eventAt(cell, playhead);
    if (!selection && event) return this.#select({ from: event.start, to: event.end, cells: [cell] });
    const room = this.#track.nextEdge(cell, playhead, true) ?? Infinity;
    const drawn = selection ?? { from: playhead, to: Math.min(playhead + NEW_EVENT, room), cells: [cell] };
    if (timeline.edit(strokes.draw(this.#track, drawn, level), 'Draw', this.#gesture)) {
      timeline.selection = drawn;
      timeline.say(`Drawn at level ${level}, ${formatTime(drawn.from)} to ${formatTime(drawn.to)}`);
    }
    return undefined;
  }

  #addLevel(by) {
    const { timeline } = this;
    const selection = timeline.selection ?? this.#eventHere();
    timeline.level += by;
    if (!selection || this.#track.spans(selection).length === 0) {
      return timeline.say(`Level ${timeline.level}`);
    }
    if (timeline.edit(strokes.addLevel(this.#track, selection, by), 'Level', this.#gesture)) {
      const levels = this.#track.spans(selection).map(({ level }) => level);
      const [least, most] = extent(levels);
      timeline.say(`Level ${least === most ? most : `${least} to ${most}`}`);
    }
    return undefined;
  }

  #eventHere() {
    const event = this.#track.eventAt(this.timeline.cell, this.timeline.playhead);
    return event && { from: event.start, to: event.end, cells: [event.cell] };
  }

  /**
   * Moves what is chosen. Steps one after the other are one move from where it began, which covers
   * nothing on its way.
   */
  #move(by) {
    const { timeline } = this;
    const { history } = timeline;
    const before = this.#moved?.to === timeline.selection ? this.#moved : null;
    const from = before?.from ?? this.#chosen();
    if (!from) return;
    if (timeline.readOnly) {
      timeline.edit([], 'Move');
      return;
    }
    this.#moved = null;
    if (before) history.undo();
    const { ms = 0, rows = 0, columns = 0 } = before?.by ?? {};
    const sum = { ms: ms + (by.ms ?? 0), rows: rows + (by.rows ?? 0), columns: columns + (by.columns ?? 0) };
    const done = strokes.clampedMove(this.#track, from, sum);
    const to = strokes.movedSelection(this.#track, from, sum);
    history.do(strokes.move(this.#track, from, sum), { label: 'Move' });
    timeline.selection = to;
    // A fraction of a frame's ms is not lost.
    if (Math.round(sum.ms) === done.ms) done.ms = sum.ms;
    this.#moved = done.ms || done.rows || done.columns ? { from, by: done, to } : null;
    timeline.reveal(to.from);
    timeline.say(`Move. Selected ${formatTime(to.from)} to ${formatTime(to.to)}`);
  }

  /** By a row of the timeline: if the grid's row ends, to the next one. */
  #moveCells(by) {
    const selection = this.#chosen();
    if (!selection) return;
    const { columns, cells } = this.#track;
    const place = (cell) => [Math.floor(cell / columns), cell % columns];
    const [row, column] = place(this.timeline.cells[0]);
    const to = Math.min(Math.max(this.timeline.cells[0] + by, 0), cells - 1);
    const [toRow, toColumn] = place(to);
    this.#move({ rows: toRow - row, columns: toColumn - column });
    if (this.timeline.selection?.cells?.length) {
      [this.timeline.cell] = this.timeline.selection.cells;
      this.timeline.reveal(this.timeline.playhead, this.timeline.cell);
      this.timeline.say(`Moved to cell ${cellName(this.timeline.cell, this.#track)}`);
    }
  }

  #stretch(frames) {
    const { frame } = this.timeline;
    const longer = ({ from, to }) =>
      ({ from, to: Math.max(Math.round(to + frames * frame), from + Math.ceil(frame)) });
    this.#change('Stretch', (track, selection) => strokes.stretch(track, selection, longer(selection)),
      (selection) => ({ ...selection, ...longer(selection) }));
  }

  #tool(tool) {
    this.timeline.tool = tool;
    this.timeline.say(`Tool: ${tool}`);
  }

  #snap() {
    this.timeline.snap = !this.timeline.snap;
    this.timeline.say(this.timeline.snap ? 'Snap on' : 'Snap off');
  }

  #tall() {
    this.timeline.tall = !this.timeline.tall;
    this.timeline.say(this.timeline.tall ? 'Tall rows' : 'All rows in view');
  }

  #copy() {
    const selection = this.#chosen();
    if (!selection) return false;
    this.#clip = strokes.copy(this.#track, selection);
    this.timeline.say('Copied');
    return true;
  }

  /** Copies of a selection of several cells begin at their own cells, others at the current one. */
  #paste() {
    const { timeline } = this;
    if (!this.#clip) return timeline.say('Nothing is copied');
    const { rows, columns, duration } = this.#clip;
    const isWhole = rows === this.#track.rows && columns === this.#track.columns;
    const [at, cell] = [timeline.playhead, isWhole ? 0 : timeline.cell];
    if (timeline.edit(strokes.paste(this.#track, this.#clip, { at, cell }), 'Paste')) {
      this.#selectClip(at, duration, cell);
      timeline.say(`Pasted at ${formatTime(at)}`);
    }
    return undefined;
  }

  #selectClip(at, duration, cell) {
    const { columns: width, rows: height } = this.#track;
    const [top, left] = [Math.floor(cell / width), cell % width];
    const cells = [];
    for (let row = top; row < Math.min(top + this.#clip.rows, height); row++) {
      for (let column = left; column < Math.min(left + this.#clip.columns, width); column++) {
        cells.push(row * width + column);
      }
    }
    this.timeline.selection = { from: at, to: at + duration, cells };
  }

  #repeat() {
    const selection = this.#chosen();
    if (!selection) return;
    const { from, to } = selection;
    const clip = strokes.copy(this.#track, selection);
    const cells = selection.cells ?? [0];
    const { columns } = this.#track;
    const cell = Math.min(...cells.map((one) => Math.floor(one / columns))) * columns
      + Math.min(...cells.map((one) => one % columns));
    if (this.timeline.edit(strokes.paste(this.#track, clip, { at: to, cell }), 'Repeat', this.#gesture)) {
      this.timeline.selection = { ...selection, from: to, to: 2 * to - from };
      this.timeline.reveal(to);
      this.timeline.say(`Repeated at ${formatTime(to)}`);
    }
  }

  #undo(again) {
    const { timeline } = this;
    if (timeline.readOnly) return timeline.say('Read only: another page writes');
    const label = again ? timeline.history.redo() : timeline.history.undo();
    const nothing = again ? 'Nothing to do again' : 'Nothing to undo';
    return timeline.say(label === null ? nothing : `${again ? 'Done again' : 'Undone'}: ${label}`);
  }
}
