// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * The cues near the playhead as a table, for those who do not see the timeline.
 *
 * Events: `seek` {ms}, `select` {selection}.
 *
 * @import {History} from './history.js'
 */
import { formatTime } from './time.js';
import { cellName, isSilent } from './track.js';

export class CueTable extends EventTarget {
  /** How many cues are listed. */
  rows = 15;
  #playhead = 0;
  #shown = [];
  #current = null;

  /**
   * @param {HTMLElement} element an empty one
   * @param {{history: History}} what
   */
  constructor(element, { history }) {
    super();
    this.history = history;
    const table = element.appendChild(document.createElement('table'));
    table.createCaption().textContent = 'Cues near the playhead';
    const head = table.createTHead().insertRow();
    for (const name of ['From', 'To', 'Felt', 'Notes']) {
      const cell = head.appendChild(document.createElement('th'));
      cell.scope = 'col';
      cell.textContent = name;
    }
    this.body = table.createTBody();
    history.addEventListener('change', () => this.#show());
    this.#show();
  }

  get playhead() {
    return this.#playhead;
  }

  set playhead(ms) {
    this.#playhead = ms;
    this.#show();
  }

  /** Makes rows only for cues that were not listed. */
  #show() {
    const { cues } = this.history.track;
    const now = this.history.track.indexAt(this.#playhead);
    const first = Math.max(Math.min(now - (this.rows >> 1), cues.length - this.rows), 0);
    const listed = cues.slice(first, first + this.rows);
    const current = this.history.track.cueAt(this.#playhead);
    if (current === this.#current && listed.length === this.#shown.length
      && listed.every((cue, i) => cue === this.#shown[i].cue)) return;
    const known = new Map(this.#shown.map(({ cue, row }) => [cue, row]));
    const left = new Set(listed);
    for (const [cue, row] of known) if (!left.has(cue)) row.remove();
    this.#shown = listed.map((cue) => ({ cue, row: known.get(cue) ?? this.#row(cue) }));
    this.#current = current;
    this.#shown.forEach(({ cue, row }, i) => {
      if (cue === current) row.setAttribute('aria-current', 'true');
      else row.removeAttribute('aria-current');
      // What stays is not moved, so that it keeps the focus.
      if (this.body.rows[i] !== row) this.body.insertBefore(row, this.body.rows[i] ?? null);
    });
  }

  #row(cue) {
    const { track } = this.history;
    const row = document.createElement('tr');
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = formatTime(cue.start);
    button.setAttribute('aria-label', `Go to the cue at ${formatTime(cue.start)}`);
    button.addEventListener('click', () => {
      this.#tell('seek', { ms: cue.start });
      this.#tell('select', { selection: { from: cue.start, to: cue.end } });
    });
    row.insertCell().append(button);
    row.insertCell().textContent = formatTime(cue.end);
    row.insertCell().textContent = isSilent(cue.levels) ? 'silent'
      : cue.levels.map((level, cell) => level > 0 && `cell ${cellName(cell, track)}: ${level} %`)
        .filter(Boolean).concat(cue.frequency ? `${cue.frequency} Hz` : []).join(', ');
    row.insertCell().textContent = (cue.notes ?? []).join(' · ');
    return row;
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }
}
