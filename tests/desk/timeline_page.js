// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * A page with a timeline and its table, as the desk puts them together. ?cues=N: as many at random, with
 * a draft, cuts, sound and thumbnails; ?side=N: a grid of N x N.
 */
import { random } from './check.js';
import * as strokes from '../../tools/tactile-track-desk/page/strokes.js';
import { CueTable } from '../../tools/tactile-track-desk/page/cue_table.js';
import { History } from '../../tools/tactile-track-desk/page/history.js';
import { Limits } from '../../tools/tactile-track-desk/page/limits.js';
import { Timeline } from '../../tools/tactile-track-desk/page/timeline.js';
import { Track } from '../../tools/tactile-track-desk/page/track.js';

const MOTOR_LIMITS = { maxOnTime: 2000, maxDuty: 0.4, dutyWindow: 60000, maxActive: 4, shortestRest: 100 };

/** As an automatic track is: a map each 200 ms, a few cells, some of them for longer. */
function authored(side, count, seed) {
  const pick = random(seed);
  const cues = [];
  let levels = new Array(side * side).fill(0);
  for (let i = 0; i < count; i++) {
    levels = levels.map((level) => (pick(0, 3) > 0 ? level : pick(0, 4) === 0 ? pick(30, 101) : 0));
    cues.push({ start: 200 * i, end: 200 * i + 200, levels, ...(i % 40 === 7 && { notes: ['softer?'] }) });
  }
  return new Track(side, side, cues);
}

const options = new URLSearchParams(location.search);
const count = Number(options.get('cues') ?? 0);
const side = Number(options.get('side') ?? 3);
const history = new History(authored(side, count, 1));
const duration = Math.max(200 * count, 60_000);
const timeline = new Timeline(document.getElementById('timeline'), { history, film: { duration, frameDuration: 40 } });
const table = new CueTable(document.getElementById('cues'), { history });
const limits = new Limits(history.track, MOTOR_LIMITS);
const told = [];
timeline.addEventListener('seek', ({ detail }) => { table.playhead = detail.ms; });
for (const name of ['seek', 'select', 'loop', 'level']) {
  timeline.addEventListener(name, ({ detail }) => told.push([name, detail]));
}
history.addEventListener('change', ({ detail: { from, to, kind } }) => {
  if (kind === 'reset') limits.reset(history.track);
  else limits.update(from, to);
  timeline.warnings = limits.warnings;
});
table.addEventListener('seek', ({ detail }) => timeline.seek(detail.ms));
table.addEventListener('select', ({ detail }) => { timeline.selection = detail.selection; });
timeline.warnings = limits.warnings;
if (count > 0) {
  timeline.draft = authored(side, count, 2);
  timeline.cuts = Array.from({ length: duration / 4000 }, (_, i) => 4000 * i + 1040);
  timeline.peaks = Uint8Array.from({ length: duration / 10 }, (_, i) => 40 + 200 * Math.abs(Math.sin(i / 90) * Math.sin(i / 7)));
  const picture = document.createElement('canvas');
  Object.assign(picture, { width: 160, height: 90 });
  Object.assign(picture.getContext('2d'), { fillStyle: '#468' }).fillRect(0, 0, 158, 90);
  timeline.setStrip({ interval: 2000, width: 160, height: 90, total: duration / 2000 }, () => picture);
}
window.desk = { history, timeline, table, limits, told, strokes, Track };
