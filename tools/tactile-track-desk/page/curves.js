// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * Levels as curves: points with straight lines between them. A track has no curves, only maps that last for
 * some time: a curve is written as a step each frame, and points are found in steps again.
 *
 * @import {Track, Span} from './track.js'
 * @typedef {{ms: number, level: number}} Point
 */
import { extent } from './track.js';

/** How far steps may be from a line that stands for them, percent. */
const TOLERANCE = 3;

/** The level of points at a time, between the first and the last. */
export function levelAt(points, ms) {
  const after = Math.max(points.findIndex((point) => point.ms >= ms), 1);
  const [a, b] = [points[after - 1], points[after]];
  return b.ms > a.ms ? a.level + (b.level - a.level) * (ms - a.ms) / (b.ms - a.ms) : b.level;
}

/** Leaves out points that are near the line between the others (Ramer, Douglas and Peucker). */
function simplified(points) {
  const [first, last] = [points[0], points.at(-1)];
  let farthest = 0;
  let most = TOLERANCE;
  for (let i = 1; i < points.length - 1; i++) {
    const off = Math.abs(points[i].level - levelAt([first, last], points[i].ms));
    if (off > most) [farthest, most] = [i, off];
  }
  return farthest === 0 ? [first, last]
    : [...simplified(points.slice(0, farthest + 1)).slice(0, -1), ...simplified(points.slice(farthest))];
}

/**
 * The points of an event: at its begin and end, and where its level bends. The shortest steps count at
 * their middle, longer ones from half of that after their begin; at both ends, the slope goes on.
 * @param {Track} track @param {Span} event
 * @returns {Point[]}
 */
export function pointsOf(track, { cell, start, end }) {
  const steps = track.spans({ from: start, to: end, cells: [cell] });
  const half = extent(steps.map((step) => step.end - step.start))[0] / 2;
  const middles = steps.flatMap((step) => [...new Set([step.start + half, step.end - half])]
    .map((ms) => ({ ms, level: step.level })));
  const outer = (ms, a, b = a) => {
    const slope = b.ms === a.ms ? 0 : (a.level - b.level) / (a.ms - b.ms);
    return { ms, level: Math.min(Math.max(a.level + slope * (ms - a.ms), 1), 100) };
  };
  return simplified([outer(start, middles[0], middles[1]), ...middles, outer(end, middles.at(-1), middles.at(-2))])
    .map(({ ms, level }) => ({ ms: Math.round(ms), level: Math.round(level) }));
}

/**
 * A curve as steps.
 * @param {number} cell @param {Point[]} points in order @param {number} frame ms, how long a step is
 * @returns {Span[]} for paint()
 */
export function spansOf(cell, points, frame) {
  const [from, to] = [points[0].ms, points.at(-1).ms];
  const count = Math.max(Math.round((to - from) / frame), 1);
  const at = (i) => Math.round(from + (to - from) * i / count);
  return Array.from({ length: count }, (_, i) => {
    const level = levelAt(points, (at(i) + at(i + 1)) / 2);
    return { cell, start: at(i), end: at(i + 1), level: Math.min(Math.max(Math.round(level), 1), 100) };
  });
}

/** The points with one more; one that is `near` ms takes its place. */
export function withPoint(points, ms, level, near) {
  const [first, last] = [points[0], points.at(-1)];
  const kept = points.filter((point) => point === first || point === last || Math.abs(point.ms - ms) > near);
  const end = [first, last].find((point) => Math.abs(point.ms - ms) <= near);
  if (end) return kept.map((point) => (point === end ? { ms: end.ms, level } : point));
  return [...kept, { ms, level }].sort((a, b) => a.ms - b.ms);
}
