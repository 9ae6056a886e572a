// SPDX-License-Identifier: LGPL-2.1-or-later
/** Tests of the page's parts that need no desk. Each export is a test. */
import { equal, fails, holds } from './check.js';
import { pointsOf, spansOf, withPoint } from '../../tools/tactile-track-desk/page/curves.js';
import { commandOf } from '../../tools/tactile-track-desk/page/keys.js';
import { OPERATIONS, request } from '../../tools/tactile-track-desk/page/operations.js';
import { Pad, rumble } from '../../tools/tactile-track-desk/page/pad.js';
import { Recorder } from '../../tools/tactile-track-desk/page/recorder.js';
import { changes } from '../../tools/tactile-track-desk/page/review.js';
import { paint } from '../../tools/tactile-track-desk/page/strokes.js';
import { formatTime, frameFrom, parseTime } from '../../tools/tactile-track-desk/page/time.js';
import { Track } from '../../tools/tactile-track-desk/page/track.js';
import { Transport } from '../../tools/tactile-track-desk/page/transport.js';

export function timesAreReadAsTheyAreWritten() {
  for (const [text, ms] of [['0', 0], ['83', 83000], ['1:23.4', 83400], ['0:01:23,456', 83456], ['1:02:03.004', 3723004],
    ['.5', null], ['1:2:3:4', null], ['-1', null], ['', null], ['1e3', null], ['12345678', null]]) {
    if (ms === null)
      fails(() => parseTime(text), /1:23\.400/);
    else
      equal(parseTime(text), ms, text);
  }
  for (const ms of [0, 7, 999, 59999, 60000, 3599999, 3600000, 359999999])
    equal(parseTime(formatTime(ms)), ms, `${ms}`);
}

export function framesAreSteppedOneByOneForHours() {
  for (const [numerator, denominator] of [[24, 1], [25, 1], [24000, 1001], [30000, 1001], [60000, 1001], [120, 1]]) {
    const frame = Number((1000 * denominator / numerator).toPrecision(15)); // as the desk tells it
    // The first whole ms of frame n, in whole numbers.
    const begin = (n) => Number((BigInt(n) * 1000n * BigInt(denominator) + BigInt(numerator) - 1n) / BigInt(numerator));
    for (const first of [0, 172560, 10_000_000]) {
      let ms = begin(first);
      for (let n = first + 1; n < first + 50; n++) {
        ms = frameFrom(ms, frame, 1);
        equal(ms, begin(n), `frame ${n} at ${numerator}/${denominator}`);
      }
      equal(frameFrom(ms, frame, -49), begin(first), `back to ${first} at ${numerator}/${denominator}`);
    }
  }
  equal(frameFrom(7_190_020, Number((1000 / 24).toPrecision(15)), 1), 7_190_042, 'from within a frame');
}

export function curvesAreFoundInTheirSteps() {
  const frame = 40;
  for (const points of [
    [[0, 20], [2000, 20]],
    [[1000, 10], [3000, 90]],
    [[0, 5], [800, 95], [1600, 30], [4000, 30]],
    [[500, 80], [1300, 20], [2100, 80], [2900, 20]],
  ]) {
    const curve = points.map(([ms, level]) => ({ ms, level }));
    const track = new Track(1, 1);
    const spans = spansOf(0, curve, frame);
    // Each step has the level of the line at its middle, by the equation of the line.
    for (const { start, end, level } of spans) {
      const middle = (start + end) / 2;
      const i = points.findLastIndex(([ms]) => ms <= middle);
      const [[a, from], [b, to]] = [points[i], points[i + 1]];
      holds(Math.abs(level - (from + (to - from) * (middle - a) / (b - a))) <= 0.5, `${level} % at ${middle}`);
    }
    track.apply(paint(track, spans));
    const found = pointsOf(track, track.eventAt(0, curve[0].ms));
    equal(found.length, curve.length, JSON.stringify(found));
    found.forEach(({ ms, level }, i) => {
      holds(Math.abs(ms - points[i][0]) <= frame && Math.abs(level - points[i][1]) <= 12, `${ms} ms ${level} % is ${points[i]}`);
    });
    // Written again, the steps are nearly the same: nothing creeps.
    const again = spansOf(0, found, frame);
    again.forEach(({ level }, i) => holds(Math.abs(level - spans[i].level) <= 4, `step ${i}: ${level}, not ${spans[i].level}`));
  }
  const line = [{ ms: 0, level: 10 }, { ms: 1000, level: 50 }];
  equal(withPoint(line, 500, 90, 20), [line[0], { ms: 500, level: 90 }, line[1]], 'a point more');
  equal(withPoint(line, 10, 90, 20), [{ ms: 0, level: 90 }, line[1]], 'ends stay at their time');
}

export function strokesAreRecordedAsHeld() {
  const got = [];
  const recorder = new Recorder((spans) => got.push(spans));
  recorder.press(0, 50, 100, 'Digit1');
  recorder.press(0, 50, 150, 'Digit1'); // a key that repeats
  recorder.press(4, 80, 200, 'Digit5');
  recorder.release('Digit1', 300);
  equal(got, [], 'committed while something is held');
  recorder.release('Digit5', 400);
  equal(got, [[{ cell: 0, start: 100, end: 300, level: 50 }, { cell: 4, start: 200, end: 400, level: 80 }]]);
}

export function aStickGoesFromCellToCellAndLevelToLevel() {
  const got = [];
  const recorder = new Recorder((spans) => got.push(spans));
  recorder.press(0, 50, 100, 'stick');
  recorder.press(0, 70, 150, 'stick');
  recorder.press(1, 70, 200, 'stick');
  recorder.release('stick', 250);
  equal(got, [[{ cell: 0, start: 100, end: 150, level: 50 }, { cell: 0, start: 150, end: 200, level: 70 },
    { cell: 1, start: 200, end: 250, level: 70 }]]);
}

export function aLoopEndsAndBeginsWhatIsHeld() {
  const got = [];
  const recorder = new Recorder((spans) => got.push(spans));
  recorder.press(2, 60, 900, 'Digit3');
  recorder.leap(1000, 500);
  recorder.stop(550);
  equal(got, [[{ cell: 2, start: 900, end: 1000, level: 60 }, { cell: 2, start: 500, end: 550, level: 60 }]]);
  equal(recorder.held.size, 0);
}

export function aGamepadPlaysTheStrongestOfEachHalf() {
  equal(rumble([10, 20, 30, 0, 50, 0, 0, 0, 40], 3), { strong: 0.5, weak: 0.4 }); // the middle column is left
  equal(rumble([0, 90], 2), { strong: 0, weak: 0.9 });
  equal(rumble([70], 1), { strong: 0.7, weak: 0 });
}

export function aGamepadIsRenewedAndStopped() {
  const calls = [];
  const actuator = {
    playEffect: (kind, effect) => (calls.push([kind, effect]), Promise.resolve('complete')),
    reset: () => (calls.push(['reset']), Promise.resolve('complete')),
  };
  navigator.getGamepads = () => [null, { id: 'a pad', connected: true, vibrationActuator: actuator }];
  document.hasFocus = () => true;
  const now = performance.now.bind(performance);
  let time = 1000;
  performance.now = () => time;
  try {
    const pad = new Pad();
    pad.play([100, 0], 2);
    equal(calls, [['dual-rumble', { startDelay: 0, duration: 250, strongMagnitude: 1, weakMagnitude: 0 }]]);
    pad.play([100, 0], 2);
    equal(calls.length, 1, 'the same again at once');
    time += 150;
    pad.play([100, 0], 2);
    equal(calls.length, 2, 'renewed before it ends');
    pad.play([0, 0], 2);
    equal(calls.at(-1)[1].strongMagnitude, 0, 'silence');
    for (const stop of [() => window.dispatchEvent(new Event('blur')), () => window.dispatchEvent(new Event('pagehide'))]) {
      pad.play([0, 30], 2);
      equal(calls.at(-1)[1].weakMagnitude, 0.3);
      stop();
      equal(calls.at(-1), ['reset']);
    }
    pad.enabled = false;
    pad.play([50, 50], 2);
    equal(calls.at(-1), ['reset'], 'switched off');
  } finally {
    performance.now = now;
  }
}

const cue = (start, end, levels, notes) => ({ start, end, levels, ...(notes && { notes }) });

export function aReviewListsWhatDiffers() {
  const draft = new Track(1, 2, [cue(0, 100, [10, 0]), cue(100, 200, [20, 0]), cue(300, 400, [0, 50]), cue(900, 1000, [0, 0])]);
  const same = new Track(1, 2, [cue(0, 100, [10, 0]), cue(100, 200, [20, 0]), cue(300, 400, [0, 50]), cue(900, 1000, [0, 0])]);
  equal(changes(draft, same), []);
  const edited = new Track(1, 2, [cue(0, 100, [10, 0]), cue(150, 250, [20, 0]), cue(500, 600, [0, 70], ['review: accepted'])]);
  const found = changes(draft, edited).map(({ start, end, before, after, cue }) => [start, end, before, after, Boolean(cue)]);
  equal(found, [
    [100, 150, [20, 0], [0, 0], false], // taken away
    [150, 250, [20, 0], [20, 0], true], // longer
    [300, 400, [0, 50], [0, 0], false],
    [500, 600, [0, 0], [0, 70], true], // new
  ]);
}

export function aReviewSeesACueThatIsCutInTwo() {
  const draft = new Track(1, 1, [cue(0, 100, [10]), cue(100, 200, [10])]);
  equal(changes(draft, new Track(1, 1, [cue(0, 200, [10])])), [], 'the same is felt');
  equal(changes(draft, new Track(1, 1, [cue(0, 50, [10]), cue(60, 200, [10])])).map(({ start, end }) => [start, end]), [[50, 60]]);
}

export function operationsAskForWhatTheDeskExpects() {
  const kind = (name) => OPERATIONS.find((each) => each.name === name);
  equal(request(kind('limit'), { longest: 2, rest: 0.5 }, null), { operation: 'limit', selection: {}, value: [2, 0.5] });
  equal(request(kind('scale'), { value: 0.8 }, { from: 1, to: 2, cells: [3] }),
    { operation: 'scale', selection: { from: 1, to: 2, cells: [3] }, value: 0.8 });
  equal(request(kind('silence'), {}, null), { operation: 'silence', selection: {} });
}

export function keysAreLeftToFieldsAndButtons() {
  const press = (element, key, more = {}) => {
    document.body.append(element);
    let found;
    element.addEventListener('keydown', (event) => { found = commandOf(event, more.single ?? true); });
    element.dispatchEvent(new KeyboardEvent('keydown', { key, code: more.code ?? '', ...more }));
    element.remove();
    return found?.command ?? null;
  };
  const make = (name, type) => Object.assign(document.createElement(name), type && { type });
  equal(press(make('div'), ' '), 'play');
  equal(press(make('button'), ' '), null, 'a button takes Space');
  equal(press(make('button'), 'k'), 'play');
  equal(press(make('textarea'), 'k'), null, 'what is typed');
  equal(press(make('input', 'text'), '1', { code: 'Digit1' }), null);
  equal(press(make('input', 'range'), '1', { code: 'Digit1' }), 'cell');
  equal(press(make('input', 'text'), 's', { ctrlKey: true }), 'save');
  equal(press(make('input', 'text'), 'z', { ctrlKey: true }), null, 'a field undoes by itself');
  equal(press(make('textarea'), 'Escape'), 'timeline', 'out of a field');
  equal(press(make('div'), 'Escape'), null);
  equal(press(make('div'), 'Z', { ctrlKey: true, shiftKey: true }), 'redo');
  equal(press(make('div'), 'r', { single: false }), null, 'switched off');
  equal(press(make('div'), 'F1', { single: false }), 'help');
  holds(press(make('div'), 'r', { altKey: true }) === null, 'Alt is the browser\'s');
}

/** Each change of a field or button makes the browser lay the page out anew, 60 times a second. */
export function aPlayingFilmChangesItsTimeAlone() {
  const bar = document.createElement('div');
  bar.innerHTML = '<output id="duration"></output><button id="back"></button><button id="forward"></button><button id="play"></button>' +
    '<button id="mute"></button><button id="loop"></button><select id="rate"><option>1</option></select><input id="time">';
  document.body.append(bar);
  const { now } = performance;
  let ms = 1000;
  performance.now = () => ms;
  try {
    const film = { duration: 60000, position: 0, paused: false, muted: false, loop: null, rate: 1 };
    const transport = new Transport(film, () => {});
    transport.show();
    const changes = new MutationObserver(() => {});
    changes.observe(bar, { attributes: true, childList: true, subtree: true, characterData: true });
    const times = new Set();
    for (let i = 1; i <= 60; i++) {
      ms = 1000 + i * 1000 / 60;
      film.position = ms - 1000;
      transport.show();
      times.add(document.getElementById('time').value);
    }
    equal(changes.takeRecords().length, 0, 'changes of buttons');
    holds(times.size >= 5 && times.size <= 11, `about ten times in a second, got ${times.size}`);
    film.paused = true;
    transport.show();
    equal(document.getElementById('time').value, formatTime(1000), 'where it has paused');
    equal(document.getElementById('play').textContent, 'Play');
  } finally {
    performance.now = now;
    bar.remove();
  }
}
