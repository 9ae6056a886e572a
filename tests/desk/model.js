// SPDX-License-Identifier: LGPL-2.1-or-later
/** Tests of track.js, strokes.js, templates.js and history.js. Each export is a test. */
import { DenseTrack } from './dense_track.js';
import { equal, fails, holds, random } from './check.js';
import { Track, difference } from '../../tools/tactile-track-desk/page/track.js';
import * as strokes from '../../tools/tactile-track-desk/page/strokes.js';
import { History } from '../../tools/tactile-track-desk/page/history.js';
import { TEMPLATES, template } from '../../tools/tactile-track-desk/page/templates.js';

const LENGTH = 4000; // ms
const text = (cues) => cues.map((cue) => JSON.stringify(cue));

/** Cues with gaps, silent ones, equal neighbors and notes. */
function randomTrack(pick, rows = 2, columns = 3) {
  const cues = [];
  let start = pick(0, 200);
  while (start < LENGTH - 1000) {
    const end = start + pick(1, 250);
    const before = cues.at(-1);
    const levels = pick(0, 5) === 0 && before ? before.levels
      : Array.from({ length: rows * columns }, () => Math.max(0, pick(-100, 101)));
    cues.push({ start, end, levels, ...(pick(0, 6) === 0 && { notes: [`note of ${start}`] }) });
    start = end + (pick(0, 2) === 0 ? 0 : pick(0, 200));
  }
  return new Track(rows, columns, cues);
}

function randomSelection(pick, track) {
  const from = pick(0, LENGTH - 1000);
  const cells = [...track.silence.keys()].filter(() => pick(0, 2) === 0);
  return { from, to: from + pick(1, 600), ...(cells.length > 0 && { cells }) };
}

/** An edit: splices by the module, and the same by brute force. */
const edits = {
  draw(track, dense, selection, pick) {
    const level = pick(0, 101);
    dense.each(selection, () => level);
    return strokes.draw(track, selection, level);
  },
  erase(track, dense, selection) {
    dense.each(selection, () => 0);
    return strokes.erase(track, selection);
  },
  setLevel(track, dense, selection, pick) {
    const level = pick(1, 101);
    dense.each(selection, (before) => (before > 0 ? level : 0));
    return strokes.setLevel(track, selection, level);
  },
  addLevel(track, dense, selection, pick) {
    const by = pick(-60, 60);
    dense.each(selection, (before) => (before > 0 ? Math.max(before + by, 1) : 0));
    return strokes.addLevel(track, selection, by);
  },
  fade(track, dense, selection, pick) {
    const { from, to } = selection;
    const [first, last, step] = [pick(0, 150), pick(0, 150), pick(10, 200)];
    const steps = Math.max(Math.round((to - from) / step), 1);
    dense.each(selection, (before, ms) => {
      let i = 0;
      while (from + Math.round((to - from) * (i + 1) / steps) <= ms) i++;
      const factor = (first + (last - first) * (i + 0.5) / steps) / 100;
      return before > 0 && factor > 0 ? Math.max(before * factor, 1) : 0;
    });
    return strokes.fade(track, selection, first, last, step);
  },
  move(track, dense, selection, pick) {
    const by = { ms: pick(-300, 300), rows: pick(-1, 2), columns: pick(-2, 3) };
    const done = strokes.clampedMove(track, selection, by);
    dense.put(dense.take(selection, true),
      (cell, ms) => [cell + done.rows * track.columns + done.columns, ms + done.ms]);
    return strokes.move(track, selection, by);
  },
  stretch(track, dense, selection, pick) {
    const from = pick(0, LENGTH - 1000);
    const to = from + pick(1, 600);
    const scaled = (ms) => Math.round(from + (ms - selection.from) * (to - from) / (selection.to - selection.from));
    // Of stretches of one level, as the shortest may be 1 ms of less.
    const spans = track.spans(selection);
    dense.take(selection, true);
    for (const { cell, start, end, level } of spans) {
      dense.levels[cell].fill(level, scaled(start), Math.max(scaled(end), scaled(start) + 1));
    }
    return strokes.stretch(track, selection, { from, to });
  },
  split(track, dense, selection, pick) {
    const [at, rest] = [selection.from, pick(1, 150)];
    for (const cell of dense.cells(selection)) {
      const event = dense.event(cell, at);
      if (event && event[0] < at && at + rest < event[1]) dense.levels[cell].fill(0, at, at + rest);
    }
    return strokes.split(track, selection, at, rest);
  },
  merge(track, dense, selection) {
    for (const cell of dense.cells(selection)) {
      const felt = dense.take({ ...selection, cells: [cell] }, false).map(([, ms]) => ms);
      for (let ms = felt[0] + 1; ms < felt.at(-1); ms++) {
        if (dense.levels[cell][ms] === 0) dense.levels[cell][ms] = dense.levels[cell][ms - 1];
      }
    }
    return strokes.merge(track, selection);
  },
  paste(track, dense, selection, pick) {
    const [at, cell] = [pick(0, LENGTH - 1000), pick(0, track.cells)];
    const cells = dense.cells(selection);
    const top = Math.min(...cells.map((one) => Math.floor(one / track.columns)));
    const left = Math.min(...cells.map((one) => one % track.columns));
    dense.put(dense.take(selection, false), (one, ms) => {
      const row = Math.floor(one / track.columns) - top + Math.floor(cell / track.columns);
      const column = one % track.columns - left + cell % track.columns;
      const inside = row < track.rows && column < track.columns;
      return [inside ? row * track.columns + column : null, ms - selection.from + at];
    });
    const clip = JSON.parse(JSON.stringify(strokes.copy(track, selection)));
    return strokes.paste(track, clip, { at, cell });
  },
  paint(track, dense, selection, pick) {
    const spans = Array.from({ length: pick(1, 6) }, () => {
      const start = pick(0, LENGTH - 1000);
      return { cell: pick(0, track.cells), start, end: start + pick(1, 300), level: pick(0, 101) };
    });
    for (const { cell, start, end, level } of spans) dense.levels[cell].fill(level, start, end);
    return strokes.paint(track, spans);
  },
};

/** No splice changes more than it must, and no cue that the edit did not touch is another one. */
function expectSmallest(before, after, splices, dense, denseBefore, what) {
  const [had, has] = [new Set(text(before)), new Set(text(after))];
  const count = (of) => splices.reduce((sum, splice) => sum + of(splice), 0);
  equal(count(({ remove }) => remove), [...had].filter((cue) => !has.has(cue)).length, `${what}: removed`);
  equal(count(({ insert }) => insert.length), [...has].filter((cue) => !had.has(cue)).length, `${what}: inserted`);
  splices.forEach(({ at, remove, insert }, i) => {
    holds(remove + insert.length > 0, `${what}: no empty splice`);
    holds(i === 0 || splices[i - 1].at + splices[i - 1].insert.length < at, `${what}: splices apart`);
  });
  const changed = (start, end) => dense.levels.some((levels, cell) => {
    for (let ms = Math.max(start, 0); ms < end; ms++) if (levels[ms] !== denseBefore.levels[cell][ms]) return true;
    return false;
  });
  for (const cue of before) {
    if (!changed(cue.start - 1, cue.end + 1)) holds(has.has(JSON.stringify(cue)), `${what}: ${cue.start} ms stays`);
  }
  const bounds = new Set(before.flatMap(({ start, end }) => [start, end]));
  after.forEach((cue, i) => {
    const next = after[i + 1];
    if (next?.start !== cue.end || !cue.levels.every((level, cell) => level === next.levels[cell])) return;
    holds(bounds.has(cue.end) && !changed(cue.end - 1, cue.end + 1), `${what}: neighbors at ${cue.end} ms joined`);
  });
}

/** 1000 random steps of edits, undo and redo against brute force; what each splice makes of a copy. */
export function edits_equal_brute_force() {
  for (const seed of [1, 2, 3]) {
    const pick = random(seed);
    const history = new History(randomTrack(pick));
    const { track } = history;
    const plain = track.cues.slice();
    const changes = [];
    history.addEventListener('change', ({ detail }) => changes.push(detail));
    const states = [[new DenseTrack(track, LENGTH), text(track.cues)]];
    let state = 0;
    let end = 0;
    const prints = new Map();
    for (let step = 0; step < 350; step++) {
      const [dense, cues] = states[state];
      const dice = pick(0, 10);
      const names = Object.keys(edits);
      const name = dice < 2 ? 'undo' : dice < 4 ? 'redo' : names[pick(0, names.length)];
      const what = `seed ${seed}, step ${step}, ${name}`;
      if (name === 'undo' || name === 'redo') {
        const next = state + (name === 'undo' ? -1 : 1);
        equal(history[name]() !== null, next in states, what);
        if (next in states) state = next;
        equal(text(track.cues), states[state][1], what);
      } else {
        end = track.end;
        const after = dense.clone();
        const before = track.cues.slice();
        const splices = edits[name](track, after, randomSelection(pick, track), pick);
        equal(text(track.cues), cues, `${what}: nothing is changed yet`);
        history.do(splices, { label: name });
        if (splices.length > 0) {
          states.splice(++state, states.length, [after, text(track.cues)]);
          equal(history.undoLabel, name, what);
        }
        after.expectLike(track, what);
        expectSmallest(before, track.cues, splices, after, dense, what);
        holds(track.end >= end, `${what}: the track is no shorter`);
        equal(strokes.paint(track, track.spans({ from: 0, to: LENGTH })), [], `${what}: what is there is no edit`);
      }
      const before = new Track(track.rows, track.columns, plain);
      for (const { splices, from, to } of changes.splice(0)) {
        for (const { at, remove, insert } of splices) plain.splice(at, remove, ...insert);
        for (let ms = 0; ms < LENGTH; ms++) {
          holds((ms >= from && ms < to) || track.at(ms).every((level, cell) => level === before.level(cell, ms)),
            `${what}: nothing changes at ${ms} ms, outside of ${from} to ${to}`);
        }
      }
      equal(text(plain), text(track.cues), `${what}: a plain copy`);
      prints.set(text(plain).join(), track.fingerprint);
      equal(track.fingerprint, new Track(track.rows, track.columns, plain).fingerprint, `${what}: its fingerprint`);
    }
    equal(new Set(prints.values()).size, prints.size, `seed ${seed}: other cues, another fingerprint`);
    while (history.undo() !== null);
    equal(text(track.cues), states[0][1], `seed ${seed}: all undone`);
    while (history.redo() !== null);
    equal(text(track.cues), states.at(-1)[1], `seed ${seed}: all done again`);
  }
}

export function look_up_equals_brute_force() {
  const pick = random(7);
  const track = randomTrack(pick);
  const dense = new DenseTrack(track, LENGTH);
  for (let ms = 0; ms < LENGTH; ms += 7) {
    equal(track.at(ms), dense.levels.map((levels) => levels[ms]), `at ${ms}`);
    for (let cell = 0; cell < track.cells; cell++) {
      const event = track.eventAt(cell, ms);
      const [start, end] = dense.event(cell, ms) ?? [];
      equal(event && [event.start, event.end, event.level],
        start === undefined ? null : [start, end, Math.max(...dense.levels[cell].slice(start, end))], `event at ${ms}`);
      const levels = dense.levels[cell];
      const edge = (at) => (levels[at] > 0) !== (levels[at - 1] > 0);
      let [next, last] = [ms + 1, ms - 1];
      while (next < LENGTH && !edge(next)) next++;
      while (last > 0 && !edge(last)) last--;
      const isEdge = (at) => (at > 0 ? edge(at) : at === 0 && levels[0] > 0);
      equal(track.nextEdge(cell, ms, true), next < LENGTH ? next : null, `edge after ${ms}`);
      equal(track.nextEdge(cell, ms, false), isEdge(last) ? last : null, `edge before ${ms}`);
    }
  }
  for (let i = 0; i < 200; i++) {
    const { from, to } = randomSelection(pick, track);
    for (let cell = 0; cell < track.cells; cell++) {
      const expected = [];
      for (let ms = from; ms < to; ms++) {
        const event = dense.event(cell, ms);
        if (event) expected.push(event);
        if (event) ms = event[1];
      }
      equal([...track.events(cell, from, to)].map(({ start, end }) => [start, end]), expected, `events ${from} to ${to}`);
    }
  }
}

/** Edits whose smallest splices are known. */
export function small_edits_make_small_splices() {
  const at = (start, end, levels, ...notes) => ({ start, end, levels, ...(notes.length > 0 && { notes }) });
  const track = new Track(1, 2, [at(0, 100, [50, 0]), at(100, 200, [50, 0]), at(200, 300, [50, 20], 'a'), at(400, 500, [0, 0])]);
  const one = (from, to, ...cells) => ({ from, to, cells });
  equal(strokes.draw(track, one(50, 150, 0), 50), [], 'what is there already');
  equal(strokes.draw(track, one(320, 350, 1), 30), [{ at: 3, remove: 0, insert: [at(320, 350, [0, 30])] }], 'in a gap');
  equal(strokes.draw(track, one(300, 320, 0), 40), [{ at: 3, remove: 0, insert: [at(300, 320, [40, 0])] }], 'beside a cue');
  equal(strokes.erase(track, one(200, 300, 1)), [{ at: 1, remove: 2, insert: [at(100, 300, [50, 0], 'a')] }],
    'joined where it was touched, and not at 100 ms');
  equal(strokes.erase(track, { from: 200, to: 300 }), [{ at: 2, remove: 1, insert: [at(200, 300, [0, 0], 'a')] }], 'a note stays');
  equal(strokes.erase(track, { from: 0, to: 200 }), [{ at: 0, remove: 2, insert: [] }], 'silent cues go away');
  equal(strokes.move(track, { from: 200, to: 300 }, { ms: 30 }),
    [{ at: 2, remove: 1, insert: [at(230, 330, [50, 20], 'a')] }], 'a note goes along');
  equal(strokes.move(track, one(200, 300, 1), { ms: 0, columns: -1 }),
    [{ at: 2, remove: 1, insert: [at(200, 300, [20, 0], 'a')] }], 'to the other cell');
  equal(strokes.draw(track, one(420, 450, 0), 10), [{ at: 3, remove: 1, insert: [at(400, 420, [0, 0]), at(420, 450, [10, 0]),
    at(450, 500, [0, 0])] }], 'within a silent cue');
  track.apply(strokes.draw(track, one(420, 450, 0), 10));
  equal(strokes.erase(track, one(420, 450, 0)), [{ at: 3, remove: 3, insert: [at(400, 500, [0, 0])] }], 'and back');
  equal(strokes.setNotes(track, 0, ['new\nlines']), [{ at: 0, remove: 1, insert: [at(0, 100, [50, 0], 'new\nlines')] }], 'a note');
  const short = new Track(1, 1, [at(0, 100, [50])]);
  equal(strokes.erase(short, { from: 50, to: 100 }), [{ at: 0, remove: 1, insert: [at(0, 50, [50]), at(50, 100, [0])] }],
    'a track keeps its length');
  equal(strokes.move(short, { from: 0, to: 100 }, { ms: 500 }), [{ at: 0, remove: 1, insert: [at(500, 600, [50])] }],
    'one that is longer needs no silent cue');
  const noted = (from, to, count) => at(from, to, [from === 0 ? 1 : 2], ...Array.from({ length: count }, (_, i) => `${from} ${i}`));
  const full = new Track(1, 1, [noted(0, 10, 10), noted(10, 20, 7)]);
  equal(strokes.setLevel(full, { from: 0, to: 10 }, 2)[0].remove, 1, 'not joined: too many notes for one cue');
  const rest = new Track(1, 1, [noted(0, 10, 10), noted(10, 20, 6)]);
  equal(strokes.setLevel(rest, { from: 0, to: 10 }, 2)[0].insert.map(({ notes }) => notes.length), [16], 'joined with its notes');
  equal(difference([], []), [], 'nothing');
  equal(strokes.split(short, { from: 0, to: 100 }, 50, 50), [], 'nothing would be left after the rest');
  equal(strokes.split(short, { from: 0, to: 100 }, 50, 20), [{ at: 0, remove: 1, insert: [at(0, 50, [50]), at(70, 100, [50])] }], 'in two');
}

export function frequencies_stay_with_what_is_felt() {
  const at = (start, end, levels, frequency) => ({ start, end, levels, ...(frequency && { frequency }) });
  const track = new Track(1, 2, [at(0, 100, [50, 0], 120), at(100, 200, [50, 0]), at(400, 500, [0, 9], 80)]);
  equal(strokes.setLevel(track, { from: 0, to: 50 }, 60)[0].insert, [at(0, 50, [60, 0], 120), at(50, 100, [50, 0], 120)], 'a level');
  equal(strokes.move(track, { from: 0, to: 100 }, { ms: 600 })[1].insert, [at(600, 700, [50, 0], 120)], 'moved');
  equal(strokes.draw(track, { from: 400, to: 500, cells: [0] }, 10)[0].insert, [at(400, 500, [10, 9], 80)], 'another cell');
  equal(strokes.move(track, { from: 100, to: 200 }, { ms: -100 })[0].insert, [at(0, 100, [50, 0])], 'moved over one with a frequency');
  equal(strokes.paste(track, strokes.copy(track, { from: 100, to: 200, cells: [0] }), { at: 400 })[0].insert, [at(400, 500, [50, 9], 80)],
    'beside one with a frequency');
  equal(strokes.setNotes(track, 0, ['a'])[0].insert, [{ ...at(0, 100, [50, 0], 120), notes: ['a'] }], 'a note');
  const other = new Track(1, 2, [at(0, 100, [50, 0], 121), ...track.cues.slice(1)]);
  holds(track.fingerprint !== other.fingerprint, 'another frequency, another fingerprint');
  const back = new Track(1, 2, track.cues);
  const { inverse } = back.apply(strokes.erase(back, { from: 0, to: 500 }));
  back.apply(inverse);
  equal(back.cues, track.cues, 'undone');
}

export function notes_stay_with_what_is_felt() {
  const at = (start, end, levels, ...notes) => ({ start, end, levels, ...(notes.length > 0 && { notes }) });
  const one = new Track(1, 2, [at(0, 100, [50, 0], 'a', 'b'), at(200, 300, [0, 10])]);
  equal(strokes.erase(one, { from: 0, to: 40 })[0].insert, [at(40, 100, [50, 0], 'a', 'b')], 'with the rest of a cue');
  equal(strokes.draw(one, { from: 50, to: 60, cells: [1] }, 9)[0].insert,
    [at(0, 50, [50, 0], 'a', 'b'), at(50, 60, [50, 9]), at(60, 100, [50, 0])], 'with the first part');
  equal(strokes.move(one, { from: 0, to: 50 }, { ms: 600 }),
    [{ at: 0, remove: 1, insert: [at(50, 100, [50, 0], 'a', 'b')] }, { at: 2, remove: 0, insert: [at(600, 650, [50, 0])] }],
    'not with a half that is moved');
  equal(strokes.move(one, { from: 50, to: 100 }, { ms: 200 })[0].insert[0], at(0, 50, [50, 0], 'a', 'b'), 'nor with the second one');
  equal(strokes.stretch(one, { from: 0, to: 100 }, { from: 400, to: 450 })[1].insert, [at(400, 450, [50, 0], 'a', 'b')], 'stretched');
  equal(strokes.move(one, { from: 0, to: 100, cells: [0] }, { ms: 200 }),
    [{ at: 0, remove: 2, insert: [at(200, 300, [50, 10], 'a', 'b')] }], 'over a cue without');
  const other = new Track(1, 2, one.cues);
  other.apply(strokes.setNotes(other, 0, ['a', 'c']));
  holds(one.fingerprint !== other.fingerprint, 'another note, another fingerprint');
  const ten = Array.from({ length: 10 }, (_, i) => `${i}`);
  const full = new Track(1, 2, [at(0, 100, [50, 0], ...ten), at(200, 300, [0, 10], ...ten)]);
  equal(strokes.move(full, { from: 0, to: 100 }, { ms: 200 }),
    [{ at: 0, remove: 2, insert: [at(0, 100, [0, 0], ...ten), at(200, 300, [50, 10], ...ten)] }], 'not to a cue that would have too many');
}

export function what_is_not_valid_changes_nothing() {
  const track = new Track(1, 1, [{ start: 0, end: 100, levels: [50] }, { start: 200, end: 300, levels: [50] }]);
  const before = text(track.cues);
  const cue = (start, end, levels = [1]) => ({ start, end, levels });
  const splice = (at, remove, ...insert) => ({ at, remove, insert });
  for (const [bad, pattern] of [
    [splice(1, 0, cue(99, 150)), /begins before 100/], [splice(1, 0, cue(150, 201)), /overlaps the next one/],
    [splice(3, 0), /cues 3 to 3/], [splice(0, 3), /cues 0 to 3/], [splice(-1, 0), /cues -1/],
    [splice(1, 0, cue(120, 120)), /whole ms/], [splice(1, 0, cue(120, 130.5)), /whole ms/],
    [splice(1, 0, cue(120, 130, [101])), /levels/], [splice(1, 0, cue(120, 130, [1, 1])), /levels/],
    [splice(2, 0, cue(300, 360_000_001)), /whole ms/], [splice(1, 0, cue(110, 120), cue(115, 130)), /begins before 120/]]) {
    fails(() => track.apply([splice(0, 1), splice(0, 0, cue(0, 100)), bad]), pattern);
    equal(text(track.cues), before, `after ${pattern}`);
  }
  fails(() => new Track(1, 1, [cue(10, 20), cue(0, 10)]), /begins before/);
  fails(() => strokes.draw(track, { from: 0, to: 10, cells: [1] }, 5), /cell of 0 to 0, got 1/);
  fails(() => strokes.draw(track, { from: 0, to: NaN }, 5), /times/);
  fails(() => strokes.stretch(track, { from: 0, to: 10 }, { from: 5, to: 5 }), /time to be felt/);
  for (const note of ['', 'a\n\nb', 'a --> b', 'x'.repeat(4097)]) fails(() => strokes.setNotes(track, 0, [note]), /note/);
  fails(() => strokes.setNotes(track, 2, []), /cue of 0 to 1/);
  equal(strokes.draw(track, { from: 10, to: 10 }, 5), [], 'no time at all');
}

/** Many edits of one gesture are one step. */
export function a_gesture_is_one_step() {
  const history = new History(new Track(1, 1));
  const drawn = (from, gesture) => history.do(strokes.draw(history.track, { from, to: from + 10 }, 50), { label: 'Paint', gesture });
  drawn(0, 1);
  for (let from = 10; from < 1000; from += 10) drawn(from, 2);
  equal(history.track.cues.length, 1, 'joined');
  history.undo();
  equal(text(history.track.cues), text([{ start: 0, end: 10, levels: [50] }]), 'the second gesture is gone');
  history.redo();
  equal(history.track.end, 1000, 'and back');
  drawn(1000, 2);
  history.undo();
  equal(history.track.end, 1000, 'a gesture ends when something else is done');
  const other = new Track(1, 1);
  history.reset(other);
  equal([history.undo(), history.redo(), history.track === other], [null, null, true], 'another track');
}

export function templates_are_what_they_say() {
  const track = new Track(2, 3);
  const made = (name, selection, options) => {
    const copy = new Track(2, 3, [{ start: 0, end: 5000, levels: [9, 9, 9, 9, 9, 9] }]);
    copy.apply(strokes.paint(copy, template(name, track, selection, options)));
    return copy;
  };
  const felt = (of, cell, from = 1000, to = 2000) => of.spans({ from, to, cells: [cell] }).map(({ start, end, level }) => [start, end, level]);
  const all = { from: 1000, to: 2000 };
  equal(felt(made('pulse', { ...all, cells: [4] }, { level: 80, on: 100, off: 300 }), 4),
    [[1000, 1100, 80], [1400, 1500, 80], [1800, 1900, 80]], 'pulses');
  equal(felt(made('ramp', all, { first: 0, last: 40, step: 200 }), 2),
    [[1200, 1400, 10], [1400, 1600, 20], [1600, 1800, 30], [1800, 2000, 40]], 'ramp');
  const beats = made('heartbeat', all, { level: 100, rate: 60 });
  equal(felt(beats, 0), [[1000, 1120, 100], [1300, 1390, 70]], 'a beat a second');
  const starts = (of) => [0, 1, 2, 3, 4, 5].map((cell) => felt(of, cell)[0]?.[0]);
  equal(starts(made('sweep', all, { overlap: 50, direction: 'right' })), [1000, 1250, 1500, 1000, 1250, 1500], 'to the right');
  equal(starts(made('sweep', all, { overlap: 50, direction: 'left' })), [1500, 1250, 1000, 1500, 1250, 1000], 'to the left');
  equal(felt(made('sweep', all, { overlap: 50, direction: 'left' }), 0), [[1500, 2000, 75]], 'it ends with the selection');
  equal(starts(made('sweep', all, { overlap: 0, direction: 'up' })), [1500, 1500, 1500, 1000, 1000, 1000], 'up');
  const one = made('sweep', { ...all, cells: [5, 0] }, { overlap: 0, direction: 'cells' });
  equal([0, 1, 5].map((cell) => felt(one, cell)), [[[1500, 2000, 75]], [[1000, 2000, 9]], [[1000, 1500, 75]]], 'in the order of the selection');
  for (const { name, options } of TEMPLATES) {
    const copy = made(name, { from: 1000, to: 1003 });
    equal([copy.level(0, 999), copy.level(0, 1003)], [9, 9], `${name} stays in its selection`);
    for (const { name: option } of options) fails(() => template(name, track, all, { [option]: -1 }), new RegExp(option));
  }
  fails(() => template('wave', track, all), /pulse,ramp,sweep,heartbeat/);
}
