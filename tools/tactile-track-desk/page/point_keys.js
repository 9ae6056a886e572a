// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * The keys for points of curves, while the tool is `curve`: one point is selected, moved and taken away.
 *
 * Points are found in steps (curves.js), where one on the line between its neighbors is none. So the points
 * of an event are held as long as they are edited here.
 *
 * @import {Point} from './curves.js'
 */
import { levelAt, pointsOf, spansOf } from './curves.js';
import { paint } from './strokes.js';
import { formatTime } from './time.js';

/** What they do, for the help. */
export const POINT_KEYS = [
  { keys: ['Ctrl+Left', 'Ctrl+Right'], does: 'To a point of the row’s curves' },
  { keys: ['Enter'], does: 'Puts a point at the playhead' },
  { keys: ['Alt+Left', 'Alt+Right'], does: 'Moves the point by a frame' },
  { keys: ['Alt+Up', 'Alt+Down'], does: 'Level of the point: 1 % more, less; + and -: 5 %' },
  { keys: ['Delete', 'Backspace'], does: 'Takes the point away' },
];

export class PointKeys {
  #edits = false;

  /** @param {import('./timeline.js').Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    timeline.history.addEventListener('change', () => {
      if (!this.#edits) timeline.held = null;
    });
    timeline.addEventListener('tool', () => { timeline.held = null; });
  }

  get #track() {
    return this.timeline.history.track;
  }

  /** @returns {boolean} whether the key is for points */
  press(name, { command, alt }, gesture) {
    const { timeline } = this;
    if (timeline.tool !== 'curve') return false;
    const key = `${command ? 'Ctrl+' : ''}${alt ? 'Alt+' : ''}${name}`;
    if (key === 'Enter') return this.#add();
    const to = { 'Ctrl+ArrowLeft': -1, 'Ctrl+ArrowRight': 1 }[key];
    if (to) return this.#go(to);
    if (!timeline.held || timeline.held.cell !== timeline.cell) return false;
    const change = {
      'Alt+ArrowLeft': { frames: -1 }, 'Alt+ArrowRight': { frames: 1 }, 'Alt+ArrowUp': { level: 1 },
      'Alt+ArrowDown': { level: -1 }, '+': { level: 5 }, '=': { level: 5 }, '-': { level: -5 }, _: { level: -5 },
    }[key];
    if (change) this.#change(change, gesture);
    else if (key === 'Delete' || key === 'Backspace') this.#remove();
    else {
      if (key === 'Escape') timeline.held = null;
      return false;
    }
    return true;
  }

  /** @returns {{cell: number, points: Point[]}[]} of the row's events, in order */
  get #curves() {
    const { cell, length } = this.timeline;
    const { held } = this.timeline;
    return [...this.#track.events(cell, 0, length)].map((event) =>
      ({ cell, points: held?.cell === cell && held.points[0].ms === event.start ? held.points : pointsOf(this.#track, event) }));
  }

  #go(to) {
    const { playhead, held } = this.timeline;
    const all = this.#curves.flatMap(({ cell, points }) => points.map((_, index) => ({ cell, points, index })));
    const at = all.findIndex(({ points, index }) => held && points === held.points && index === held.index);
    const ms = ({ points, index }) => points[index].ms;
    const found = at >= 0 ? all[at + to]
      : to > 0 ? all.find((one) => ms(one) > playhead) : all.findLast((one) => ms(one) < playhead);
    if (found) this.#hold(found);
    else this.timeline.say(`No point ${to > 0 ? 'after' : 'before'}`);
    return true;
  }

  #hold(held) {
    const { timeline } = this;
    timeline.held = held;
    const { ms } = held.points[held.index];
    timeline.seek(ms);
    timeline.reveal(ms, held.cell);
    this.#say('Point');
  }

  #say(what) {
    const { points, index } = this.timeline.held;
    const { ms, level } = points[index];
    this.timeline.say(`${what} ${index + 1} of ${points.length}, ${formatTime(ms)}, level ${level}`);
  }

  #add() {
    const { playhead, cell } = this.timeline;
    const curve = this.#curves.find(({ points }) => points[0].ms < playhead && playhead < points.at(-1).ms);
    if (!curve) return false;
    const { points } = curve;
    const there = points.findIndex(({ ms }) => ms === playhead);
    const index = there >= 0 ? there : points.findIndex(({ ms }) => ms > playhead);
    const point = { ms: playhead, level: Math.round(levelAt(points, playhead)) };
    this.#hold({ cell, index, points: there >= 0 ? points : points.toSpliced(index, 0, point) });
    return true;
  }

  #change({ frames = 0, level = 0 }, gesture) {
    const { frame, held: { cell, points, index } } = this.timeline;
    const point = points[index];
    const [before, after] = [points[index - 1], points[index + 1]];
    if (frames && !(before && after)) {
      this.timeline.say('The ends of an event move with its edges');
      return;
    }
    const one = Math.ceil(frame);
    const ms = frames ? Math.min(Math.max(Math.round(point.ms + frames * frame), before.ms + one), after.ms - one) : point.ms;
    const moved = { ms, level: Math.min(Math.max(point.level + level, 1), 100) };
    this.#write({ cell, index, points: points.with(index, moved) }, 'Point', gesture);
  }

  #remove() {
    const { cell, points, index } = this.timeline.held;
    if (index === 0 || index === points.length - 1) {
      this.timeline.say('An event keeps the points at its ends');
      return;
    }
    this.#write({ cell, index: index - 1, points: points.toSpliced(index, 1) }, 'Point taken away; now');
  }

  #write(held, what, gesture = null) {
    const { timeline } = this;
    if (timeline.readOnly) {
      timeline.edit([], 'Curve');
      return;
    }
    this.#edits = true;
    timeline.history.do(paint(this.#track, spansOf(held.cell, held.points, timeline.frame)), { label: 'Curve', gesture });
    this.#edits = false;
    this.#hold(held);
    this.#say(what);
  }
}
