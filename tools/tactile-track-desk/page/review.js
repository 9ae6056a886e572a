// SPDX-License-Identifier: LGPL-2.1-or-later
import * as strokes from './strokes.js';
import { element } from './forms.js';
import { formatTime } from './time.js';
import { isSilent } from './track.js';

const ACCEPTED = 'review: accepted';
const AT_ONCE = 25; // changes that are listed

const same = (a, b) => a.every((level, cell) => level === b[cell]);
const accepted = (cue) => Boolean(cue?.notes?.includes(ACCEPTED));

/**
 * What a designer has changed, cue by cue.
 * @param {Track} draft
 * @param {Track} track
 * @returns {{start: number, end: number, before: number[], after: number[], cue: Cue|null}[]} `before`
 *   is the strongest level of each cell in the draft meanwhile, `cue` the edited one if there is one
 */
export function changes(draft, track) {
  const found = [];
  const compare = (start, end, cue) => {
    const silence = Array(track.cells).fill(0);
    const after = cue?.levels ?? silence;
    const before = [...silence];
    let differs = false;
    let until = start;
    for (let i = Math.max(draft.indexAt(start), 0); i < draft.cues.length && draft.cues[i].start < end; i++) {
      const each = draft.cues[i];
      if (each.end <= start)
        continue;
      differs ||= !same(each.levels, after) || (each.start > until && !isSilent(after));
      each.levels.forEach((level, cell) => { before[cell] = Math.max(before[cell], level); });
      until = each.end;
    }
    differs ||= until < end && !isSilent(after);
    if (differs || accepted(cue))
      found.push({ start, end, before, after, cue });
  };
  // What the draft has where the edited track has no cue, a cue of the draft at a time.
  const gap = (from, to) => {
    for (let i = Math.max(draft.indexAt(from), 0); i < draft.cues.length && draft.cues[i].start < to; i++) {
      const { start, end } = draft.cues[i];
      if (Math.max(start, from) < Math.min(end, to))
        compare(Math.max(start, from), Math.min(end, to), null);
    }
  };
  let until = 0;
  for (const cue of track.cues) {
    gap(until, cue.start);
    compare(cue.start, cue.end, cue);
    until = cue.end;
  }
  gap(until, Infinity);
  return found;
}

function picture(track, levels, name) {
  const felt = levels.map((level, cell) => (level ? `cell ${cell + 1} ${level} %` : '')).filter(Boolean);
  const label = `${name}: ${felt.join(', ') || 'silent'}`;
  const grid = element('span', { className: 'map', title: label });
  grid.setAttribute('role', 'img');
  grid.setAttribute('aria-label', label);
  grid.style.gridTemplateColumns = `repeat(${track.columns}, 1fr)`;
  for (const level of levels) {
    const cell = element('i', {}, level ? `${level}` : '');
    cell.style.setProperty('--level', level / 100);
    grid.append(cell);
  }
  return grid;
}

/** Draft and edited track side by side: each change is accepted or rejected, and commented. */
export class Review {
  #desk;
  #element;
  #first = 0;
  #all = false;

  /** @param {HTMLElement} element empty @param {object} desk history, draft, say, failed, play(from, to) */
  constructor(element, desk) {
    this.#element = element;
    this.#desk = desk;
  }

  /** After the track has changed, or to begin. */
  show() {
    if (this.#element.hidden)
      return;
    const { draft, draftFailed, history: { track } } = this.#desk;
    if (!draft) {
      const why = draftFailed
        ? 'There is no automatic draft to compare with. The terminal where "tactile-track desk" runs says why.'
        : 'The automatic draft is being made. The changes are listed when it is there.';
      this.#element.replaceChildren(element('h2', {}, 'Review'), element('p', {}, why));
      return;
    }
    const all = changes(draft, track);
    const open = all.filter(({ cue }) => !accepted(cue));
    const listed = this.#all ? all : open;
    this.#first = Math.max(0, Math.min(this.#first, Math.floor((listed.length - 1) / AT_ONCE) * AT_ONCE));
    const page = listed.slice(this.#first, this.#first + AT_ONCE);
    const filter = element('input', { type: 'checkbox', checked: this.#all });
    filter.addEventListener('change', () => {
      this.#all = filter.checked;
      this.show();
    });
    const title = `${open.length} of ${all.length} changes to decide`;
    const head = ['Time', 'Draft', 'Edited', 'Comment', 'Decision'].map((text) => element('th', { scope: 'col' }, text));
    const table = element('table', {}, element('caption', {}, title), element('thead', {}, element('tr', {}, ...head)),
      element('tbody', {}, ...page.map((change) => this.#row(track, change))));
    const turn = (label, by) => {
      const button = element('button', { type: 'button', disabled: !listed[this.#first + by] }, label);
      button.addEventListener('click', () => {
        this.#first += by;
        this.show();
      });
      return button;
    };
    this.#keepFocus(() => this.#element.replaceChildren(element('h2', {}, 'Review'),
      element('label', {}, filter, ' Also those that are accepted'), table,
      ...(listed.length > AT_ONCE ? [turn('Earlier', -AT_ONCE), ' ', turn('Later', AT_ONCE)] : [])));
  }

  /** The button with the same name in the same row has the focus again. */
  #keepFocus(change) {
    const controls = () => [...this.#element.querySelectorAll('tbody tr')];
    const row = controls().findIndex((each) => each.contains(document.activeElement));
    const name = document.activeElement?.dataset?.name;
    change();
    if (row >= 0) {
      const rows = controls();
      const next = rows[Math.min(row, rows.length - 1)];
      (next?.querySelector(`[data-name="${name}"]:enabled`) ?? next?.querySelector('button') ??
        this.#element.querySelector('input'))?.focus();
    }
  }

  #row(track, change) {
    const { start, end, before, after, cue } = change;
    const time = `${formatTime(start)} to ${formatTime(end)}`;
    const button = (name, label, act) => {
      const made = element('button', { type: 'button' }, label);
      made.dataset.name = name;
      made.setAttribute('aria-label', `${label}, ${time}`);
      made.disabled = name !== 'play' && this.#desk.readOnly;
      made.addEventListener('click', act);
      return made;
    };
    const mine = (cue?.notes ?? []).filter((note) => note !== ACCEPTED);
    const comment = element('textarea', { rows: 2, value: mine.join('\n\n'), disabled: this.#desk.readOnly });
    comment.setAttribute('aria-label', `Comment, ${time}`);
    comment.addEventListener('change', () => {
      const notes = comment.value.split(/\n\s*\n/).map((note) => note.trim()).filter(Boolean);
      this.#note(change, [...notes, ...(accepted(cue) ? [ACCEPTED] : [])], 'Comment');
    });
    const decide = accepted(cue)
      ? [button('accept', 'Undecided', () => this.#note(change, mine, 'Take acceptance back'))]
      : [button('accept', 'Accept', () => this.#note(change, [...mine, ACCEPTED], 'Accept')),
        button('reject', 'Reject', () => this.#reject(change))];
    const cells = [
      [button('play', time, () => this.#desk.play(start, end))], [picture(track, before, 'Draft')],
      [picture(track, after, 'Edited')], [comment], decide,
    ];
    return element('tr', {}, ...cells.map((children) => element('td', {}, ...children)));
  }

  /** The notes of a change's cue; where the designer left silence, they need a silent cue. */
  #note({ start, end, cue }, notes, label) {
    const { track } = this.#desk.history;
    try {
      const at = track.indexAt(start);
      const silent = { start, end, levels: Array(track.cells).fill(0), notes };
      const splices = cue ? strokes.setNotes(track, at, notes) : [{ at: at + 1, remove: 0, insert: [silent] }];
      this.#desk.history.do(splices, { label });
      this.#desk.say(`${label}: ${formatTime(start)}`);
    } catch (thrown) {
      this.#desk.failed(thrown);
    }
  }

  #reject({ start, end }) {
    const { draft, history } = this.#desk;
    const selection = { from: start, to: end };
    const silence = Array.from({ length: draft.cells }, (_, cell) => ({ cell, start, end, level: 0 }));
    history.do(strokes.paint(history.track, [...silence, ...draft.spans(selection)]), { label: 'Reject' });
    this.#desk.say(`Rejected: ${formatTime(start)}`);
  }
}
