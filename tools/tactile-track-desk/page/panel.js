// SPDX-License-Identifier: LGPL-2.1-or-later
import * as strokes from './strokes.js';
import { Hint, choiceForm, element } from './forms.js';
import { TEMPLATES, template } from './templates.js';
import { formatTime, parseTime } from './time.js';
import { extent } from './track.js';

const noteLines = (text) => text.split(/\n\s*\n/).map((note) => note.trim()).filter(Boolean);

const FIELDS = ['start', 'end', 'level', 'fadeIn', 'fadeOut', 'comment'];

/** What the selection is, and forms that change it. */
export class Panel {
  #desk;
  #form = document.getElementById('selection');
  #clip = null;
  #applies = false;
  #shown = ''; // the selection whose values the fields have

  /**
   * @param {{history: History, timeline: Timeline, film: Film, say: function(string), failed: function(Error)}} desk
   */
  constructor(desk) {
    this.#desk = desk;
    this.#form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#applies = true;
      this.#try(() => this.#apply());
      this.#applies = false;
    });
    for (const button of document.querySelectorAll('[data-edit]'))
      button.addEventListener('click', () => this.#try(() => this.#edit(button.dataset.edit)));
    choiceForm(document.getElementById('templates'), 'Template', TEMPLATES, ({ name, label }, values) => {
      const selection = this.#selected();
      this.#do((track) => strokes.paint(track, template(name, track, selection, values)), label);
    });
    this.show();
  }

  /** After the selection or the track has changed. */
  show() {
    const { history: { track }, timeline: { selection } } = this.#desk;
    const text = document.getElementById('selection-text');
    for (const control of document.querySelectorAll('#selection *, [data-edit]'))
      control.disabled = !selection || this.#desk.readOnly;
    document.querySelector('[data-edit=paste]').disabled = !this.#clip || this.#desk.readOnly;
    document.querySelector('[data-edit=copy]').disabled = !selection;
    if (!selection) {
      text.textContent = 'Nothing is selected. In the timeline, Enter selects what the playhead is at.';
      this.#form.reset();
      return;
    }
    const { from, to, cells } = selection;
    const levels = track.spans(selection).map(({ level }) => level);
    const [least, most] = levels.length ? extent(levels) : [0, 0];
    const where = cells && cells.length < track.cells ? `cell ${cells.map((cell) => cell + 1).join(', ')}` : 'all cells';
    const felt = !levels.length ? 'silent' : least === most ? `${most} %` : `${least} to ${most} %`;
    const frequency = this.#cueAt(from)?.frequency;
    text.textContent = `${formatTime(from)} to ${formatTime(to)} (${formatTime(to - from)}), ${where}, ${felt}${frequency ? `, ${frequency} Hz` : ''}.`;
    const shown = JSON.stringify(selection);
    if (!this.#applies && this.#shown === shown && this.#isTyped())
      return;
    this.#shown = shown;
    const notes = this.#cueAt(from)?.notes ?? [];
    this.#fill({ start: formatTime(from), end: formatTime(to), level: most || '', fadeIn: 0, fadeOut: 0,
      comment: notes.join('\n\n') });
  }

  /** Whether something is being typed, and not applied yet. */
  #isTyped() {
    return this.#form.contains(document.activeElement)
      && FIELDS.map((name) => this.#form.elements[name]).some(({ value, defaultValue }) => value !== defaultValue);
  }

  #fill(values) {
    for (const [name, value] of Object.entries(values)) {
      const control = this.#form.elements[name];
      control.value = control.defaultValue = value;
    }
  }

  #cueAt(ms) { return this.#desk.history.track.cueAt(ms); }

  #selected() {
    const { selection } = this.#desk.timeline;
    if (!selection)
      throw new Hint('Select some time first: in the timeline by Enter, or by I and O at its begin and end.');
    return selection;
  }

  #do(edit, label, gesture) {
    const { history } = this.#desk;
    if (this.#desk.readOnly)
      throw new Hint('This page only reads. Take over first.');
    history.do(edit(history.track), { label, gesture });
  }

  #try(run) {
    try {
      run();
    } catch (thrown) {
      this.#desk.failed(thrown);
    }
  }

  #apply() {
    const { elements } = this.#form;
    const changed = (name) => elements[name].value !== elements[name].defaultValue;
    let selection = this.#selected();
    const gesture = {};
    const notes = changed('comment') ? noteLines(elements.comment.value) : null;
    const level = changed('level') ? Number(elements.level.value) : null;
    const fades = ['fadeIn', 'fadeOut'].map((name) => Math.min(Number(elements[name].value), selection.to - selection.from));
    if (changed('start') || changed('end')) {
      const to = { from: parseTime(elements.start.value), to: parseTime(elements.end.value) };
      this.#do((track) => strokes.stretch(track, selection, to), 'Move', gesture);
      selection = { ...selection, ...to };
      this.#desk.timeline.selection = selection;
    }
    if (level)
      this.#do((track) => strokes.setLevel(track, selection, level), 'Level', gesture);
    const { from, to } = selection;
    if (fades[0] > 0)
      this.#do((track) => strokes.fade(track, { ...selection, to: from + fades[0] }, 0, 100), 'Fade in', gesture);
    if (fades[1] > 0)
      this.#do((track) => strokes.fade(track, { ...selection, from: to - fades[1] }, 100, 0), 'Fade out', gesture);
    if (notes) {
      if (!this.#cueAt(from))
        throw new RangeError(`A comment belongs to a cue, and nothing is felt at ${formatTime(from)}.`);
      this.#do((track) => strokes.setNotes(track, track.indexAt(from), notes), 'Comment', gesture);
    }
    this.#desk.say('Applied');
    this.show();
    this.#form.dispatchEvent(new Event('applied', { bubbles: true }));
  }

  #edit(name) {
    const { film, history: { track }, timeline } = this.#desk;
    const now = film.position;
    if (name === 'paste') {
      const [cell = 0] = timeline.selection?.cells ?? [];
      this.#do((track) => strokes.paste(track, this.#clip, { at: now, cell }), 'Paste');
      return;
    }
    const selection = this.#selected();
    if (name === 'copy') {
      this.#clip = strokes.copy(track, selection);
      this.#desk.say('Copied');
      this.show();
    } else if (name === 'split')
      this.#do((track) => strokes.split(track, selection, now), 'Split');
    else
      this.#do((track) => strokes[name](track, selection), name === 'merge' ? 'Merge' : 'Delete');
  }
}

/** The list of warnings, each a button that goes there. At most 200 are listed. */
export function showWarnings(warnings, go) {
  const most = 200;
  document.getElementById('warning-count').textContent = `(${warnings.length})`;
  document.getElementById('warnings-tab').classList.toggle('some', warnings.length > 0);
  const items = warnings.slice(0, most).map((warning) => {
    const button = element('button', { type: 'button' }, `${formatTime(warning.start)}: ${warning.text}`);
    button.addEventListener('click', () => go(warning));
    return element('li', {}, button);
  });
  if (warnings.length > most)
    items.push(element('li', {}, `and ${warnings.length - most} more`));
  document.getElementById('warning-list').replaceChildren(...items);
}
