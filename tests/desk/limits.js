// SPDX-License-Identifier: LGPL-2.1-or-later
/** Tests of limits.js. Each export is a test. */
import { DenseTrack } from './dense_track.js';
import { equal, holds, random } from './check.js';
import { Track } from '../../tools/tactile-track-desk/page/track.js';
import * as strokes from '../../tools/tactile-track-desk/page/strokes.js';
import { Limits } from '../../tools/tactile-track-desk/page/limits.js';

const LENGTH = 4000; // ms

/** Each ms at which a limit is broken, by its definition. */
function broken(track, { maxOnTime, maxDuty, dutyWindow, maxActive, shortestRest }) {
  const dense = new DenseTrack(track, LENGTH);
  const found = new Set();
  dense.levels.forEach((levels, cell) => {
    let [begin, silent, used] = [0, Infinity, 0];
    for (let ms = 0; ms < LENGTH; ms++) {
      const on = levels[ms] > 0;
      if (on && silent >= Math.max(shortestRest, 1)) begin = ms;
      silent = on ? 0 : silent + 1;
      used += (on ? 1 : 0) - (levels[ms - dutyWindow] > 0 ? 1 : 0);
      if (on && maxOnTime > 0 && ms - begin >= maxOnTime) found.add(`time ${cell} ${ms}`);
      if (on && maxDuty > 0 && maxDuty < 1 && used > Math.round(maxDuty * dutyWindow)) found.add(`duty ${cell} ${ms}`);
    }
  });
  for (let ms = 0; ms < LENGTH; ms++) {
    const active = dense.levels.filter((levels) => levels[ms] > 0).length;
    if (maxActive > 0 && active > maxActive) found.add(`active -1 ${ms}`);
  }
  return [...found].sort();
}

function listed(warnings) {
  const found = new Set();
  for (const { kind, cell, start, end } of warnings) {
    for (let ms = start; ms < end; ms++) {
      const key = `${kind} ${cell} ${ms}`;
      holds(!found.has(key), `${key} is told once`);
      found.add(key);
    }
  }
  return [...found].sort();
}

/** After each of many edits, what is found again is what brute force finds, and in as few warnings as anew. */
export function warnings_equal_brute_force() {
  const pick = random(11);
  let most = 0;
  for (let round = 0; round < 30; round++) {
    const limits = { maxOnTime: pick(0, 5) * 60, maxDuty: pick(0, 12) / 10, dutyWindow: pick(100, 900), maxActive: pick(0, 3),
      shortestRest: pick(0, 60) };
    const track = new Track(1, 3);
    const kept = new Limits(track, limits);
    for (let step = 0; step < 25; step++) {
      const from = pick(0, LENGTH - 700);
      const selection = { from, to: from + pick(1, 500), cells: [pick(0, 3)] };
      const dice = pick(0, 4);
      const splices = dice === 0 ? strokes.erase(track, selection)
        : dice === 1 ? strokes.move(track, selection, { ms: pick(-200, 200), columns: pick(-1, 2) })
          : strokes.draw(track, selection, pick(1, 101));
      const { from: first, to } = track.apply(splices);
      kept.update(first, to);
      const what = `round ${round}, step ${step}, ${JSON.stringify(limits)}`;
      equal(listed(kept.warnings), broken(track, limits), what);
      equal(kept.warnings, new Limits(track, limits).warnings, `${what}: as anew`);
      most = Math.max(most, kept.warnings.length);
    }
  }
  holds(most > 20, `many warnings, got ${most}`);
}

/** Those of a chair, with the times that lib/tactor/motor_limits.h gives. */
export function a_chairs_limits() {
  const limits = { maxOnTime: 2000, maxDuty: 0.4, dutyWindow: 60000, maxActive: 2, shortestRest: 100 };
  const cue = (start, end, ...levels) => ({ start, end, levels });
  const of = (...cues) => new Limits(new Track(1, 3, cues), limits).warnings;
  equal(of(cue(0, 2000, 9, 0, 0)), [], '2 s are allowed');
  equal(of(cue(0, 2100, 9, 0, 0), cue(2199, 2250, 9, 0, 0)).map(({ start, end }) => [start, end]), [[2000, 2100], [2199, 2250]],
    'a break of 99 ms is none');
  equal(of(cue(0, 1990, 9, 0, 0), cue(2090, 4090, 5, 0, 0)), [], 'one of 100 ms is a rest');
  equal(of(cue(0, 2500, 0, 9, 0))[0].text, 'Cell 2 is felt for more than 2 s without a break');
  equal(of(cue(0, 10, 1, 1, 1), cue(10, 20, 2, 2, 2), cue(20, 30, 0, 2, 2)),
    [{ kind: 'active', cell: -1, start: 0, end: 20, text: 'More than 2 cells are felt at once' }], 'three of two');
  const half = Array.from({ length: 40 }, (_, i) => cue(2000 * i, 2000 * i + 1000, 0, 0, 7));
  const [first, ...others] = of(...half);
  equal([first.kind, first.start, first.end], ['duty', 48000, 49000], '24 s in the first 48 s are the most');
  equal([first.text, others.length], ['Cell 3 is felt for more than 40 % of 60 s', 15], 'then each');
  equal(new Limits(new Track(1, 3, half), { ...limits, maxDuty: 1 }).warnings, [], 'a duty of 1 is off');
  const long = new Limits(new Track(1, 3, half), limits);
  long.reset(new Track(1, 3));
  equal(long.warnings, [], 'another track');
}
