// SPDX-License-Identifier: LGPL-2.1-or-later
/** Tests of sync.js with a desk that loses requests and answers. Each export is a test. */
import { equal, holds, random } from './check.js';
import { Track } from '../../tools/tactile-track-desk/page/track.js';
import * as strokes from '../../tools/tactile-track-desk/page/strokes.js';
import { History } from '../../tools/tactile-track-desk/page/history.js';
import { Sync } from '../../tools/tactile-track-desk/page/sync.js';

/** What the desk does by its HTTP interface. fault() → 'lost', 'unheard', 'full' or nothing. */
class Desk {
  constructor(fault = () => null) {
    Object.assign(this, { fault, revision: 0, saved: 0, cues: [], answered: new Map(), writer: 'a', requests: [] });
  }

  send = async (path, body) => {
    const { page, edit, revision, splices } = body;
    this.requests.push(structuredClone(body));
    const fault = this.fault();
    await null;
    if (fault === 'lost') throw new TypeError('Failed to fetch');
    if (page !== this.writer) return { status: 423, body: { writer: this.writer, error: 'another page writes' } };
    if (path === 'save') {
      this.saved = this.revision;
      return { status: 200, body: { revision: this.revision, saved: this.saved } };
    }
    if (fault === 'full') return { status: 507, body: { error: 'no room on the disk' } };
    if (!this.answered.has(edit)) {
      if (revision !== this.revision) return { status: 409, body: { revision: this.revision, error: 'another revision' } };
      for (const { at, remove, insert } of JSON.parse(JSON.stringify(splices))) this.cues.splice(at, remove, ...insert);
      this.answered.set(edit, ++this.revision);
    }
    if (fault === 'unheard') throw new TypeError('Failed to fetch');
    return { status: 200, body: { revision: this.answered.get(edit), saved: this.saved } };
  };
}

let names = 0;

/** A page of a desk; its storage is the browser's. */
function page(desk, { name = 'a', track = `track ${names++}`, cues = [], ...others } = {}) {
  const history = new History(new Track(1, 1, cues));
  const sync = new Sync(history, { page: name, send: desk.send, revision: desk.revision, saved: desk.saved, name: track,
    wait: () => Promise.resolve(), ...others });
  const draw = (from, level = 50) => history.do(strokes.draw(history.track, { from, to: from + 10 }, level));
  return { history, sync, draw, track };
}

/** Until the state is one of these; the tests' time limit is theirs. */
async function until(sync, ...states) {
  while (!states.includes(sync.state)) await new Promise((done) => sync.addEventListener('state', done, { once: true }));
}

export async function edits_arrive_in_order_whatever_is_lost() {
  const pick = random(5);
  const desk = new Desk(() => [null, null, 'lost', 'unheard', 'full'][pick(0, 5)]);
  const { history, sync, draw } = page(desk);
  equal([sync.state, sync.text], ['saved', 'Saved']);
  for (let i = 0; i < 300; i++) {
    const dice = pick(0, 6);
    if (dice === 0) history.undo();
    else if (dice === 1) history.redo();
    else draw(pick(0, 100) * 7, pick(0, 101));
    if (pick(0, 5) === 0) await null;
    if (pick(0, 60) === 0) await until(sync, 'journal');
  }
  await until(sync, 'journal');
  equal(desk.cues, history.track.cues, 'the desk has the track');
  equal([sync.pending, sync.revision], [0, desk.revision]);
  equal(localStorage.getItem(sync.prefix + 'a'), null, 'nothing is left in storage');
  holds(new Set(desk.requests.map(({ edit }) => edit)).size < 250, 'edits go together');
  desk.fault = () => null;
  equal(await sync.save(), { revision: desk.revision, saved: desk.revision });
  equal(sync.state, 'saved');
}

export async function a_killed_page_loses_nothing() {
  for (const fault of ['lost', 'unheard']) {
    const desk = new Desk();
    const first = page(desk);
    first.draw(0);
    await until(first.sync, 'journal');
    desk.fault = () => fault;
    const waiting = new Promise(() => {});
    first.sync.wait = () => waiting; // killed before it tries again
    first.draw(20);
    first.draw(40);
    const notes = new Array(16).fill('x'.repeat(4096)); // so much that what follows goes on its own
    first.history.do([{ at: 3, remove: 0, insert: Array.from({ length: 17 }, (_, i) => ({ start: 1000 + i, end: 1001 + i, levels: [i], notes })) }]);
    first.draw(60);
    await until(first.sync, 'waiting');
    equal(first.sync.pending, 4);
    equal(desk.cues.length, fault === 'lost' ? 1 : 2, fault);
    desk.fault = () => null;
    // It was killed, too: it counts anew what is in its journal.
    desk.revision = desk.cues.length + 40;
    let second = page(desk, { name: 'b', track: first.track, cues: desk.cues });
    equal(await second.sync.recover(), { sent: 0, kept: 0 }, 'not while another page writes');
    desk.writer = 'b';
    second = page(desk, { name: 'b', track: first.track, cues: desk.cues });
    equal(await second.sync.recover(), { sent: fault === 'lost' ? 4 : 3, kept: 0 });
    equal(desk.cues, first.history.track.cues);
    equal(await second.sync.recover(), { sent: 0, kept: 0 }, 'once');
    second.sync.reload(new Track(1, 1, desk.cues), desk.revision, desk.saved);
    second.draw(80);
    await until(second.sync, 'journal');
    equal(desk.cues.length, 22);
  }
}

export async function what_does_not_fit_is_kept() {
  const desk = new Desk();
  const { history, sync, draw, track } = page(desk);
  draw(0);
  await until(sync, 'journal');
  desk.revision = 7; // somebody else
  draw(20);
  await until(sync, 'conflict');
  draw(40);
  const asked = desk.requests.length;
  holds(/Not sent: 2 edits, kept in this browser. Load it again/.test(sync.text), sync.text);
  const mine = history.track.cues.slice();
  await sync.save().then(() => holds(false, 'not saved'), (error) => holds(/Load it again/.test(error.message), error.message));
  equal(await sync.recover(), { sent: 0, kept: 0 }, 'its own edits are not those of a killed page');
  equal(desk.requests.length, asked, 'nothing more is sent');
  sync.reload(new Track(1, 1, [{ start: 5, end: 6, levels: [1] }]), 7, 0);
  equal(sync.kept.map(({ edits, cues }) => [edits.length, cues]), [[2, mine]]);
  equal([history.undo(), sync.state], [null, 'journal'], 'the loaded track');
  const other = page(desk, { track });
  equal(other.sync.kept.length, 1, 'after the browser was closed, too');
  other.sync.forget(0);
  equal(sync.kept, []);
  localStorage.setItem(`${sync.prefix}x`, JSON.stringify([{ edit: 'e', splices: [], count: 4, before: 'another', after: 'track' }]));
  localStorage.setItem(`${sync.prefix}y`, '{"of": "another version"}');
  localStorage.setItem(`${sync.prefix}z`, '[');
  const before = desk.requests.length;
  equal(await other.sync.recover(), { sent: 0, kept: 4 }, 'a killed page whose track has changed');
  equal([other.sync.kept.length, localStorage.getItem(`${sync.prefix}x`), desk.requests.length], [1, null, before], 'is not asked');
}

export async function another_page_writes() {
  const desk = new Desk();
  const { sync, draw } = page(desk);
  desk.writer = 'b';
  draw(0);
  await until(sync, 'reader');
  draw(20);
  holds(/Not sent: 2 edits, kept in this browser. Take over/.test(sync.text), sync.text);
  equal(desk.requests.length, 1, 'it waits');
  desk.writer = 'a';
  sync.retry();
  await until(sync, 'journal');
  equal(desk.cues.length, 2);
}

export async function refused_and_full() {
  const desk = new Desk();
  const full = { getItem: () => null, removeItem() {}, setItem() { throw new DOMException('full', 'QuotaExceededError'); } };
  const { history, sync, draw } = page(desk, { storage: full });
  draw(0);
  await until(sync, 'journal');
  equal(desk.cues, history.track.cues, 'sent all the same');
  desk.send = async () => ({ status: 400, body: { error: 'expected a cue' } });
  sync.send = desk.send;
  draw(20);
  await until(sync, 'refused');
  holds(/Refused: expected a cue. Not sent: 1 edit, only in this page/.test(sync.text), sync.text);
}
