// SPDX-License-Identifier: LGPL-2.1-or-later
import * as desk from './desk.js';
import { CueTable } from './cue_table.js';
import { Feel } from './feel.js';
import { Film } from './film.js';
import { Hint, choiceForm } from './forms.js';
import { Grid } from './grid.js';
import { History } from './history.js';
import { commandOf, keyTables, rememberSingleKeys } from './keys.js';
import { Layout } from './layout.js';
import { Limits } from './limits.js';
import { drawMap } from './map_view.js';
import { Minimap } from './minimap.js';
import { fail, failed, offerKept, offerSaveOver, say, tell } from './notices.js';
import { OPERATIONS, request } from './operations.js';
import { Panel, showWarnings } from './panel.js';
import { Review } from './review.js';
import { Strip } from './strip.js';
import { paint } from './strokes.js';
import { Sync } from './sync.js';
import { Tabs } from './tabs.js';
import { formatTime } from './time.js';
import { Timeline } from './timeline.js';
import { Toolbar } from './toolbar.js';
import { Track } from './track.js';
import { Transport } from './transport.js';
import { UndoStore } from './undo_store.js';

const $ = (id) => document.getElementById(id);

/** Everything of one page, once the desk has told what is edited. */
class Page {
  readOnly = true;
  draft = null;
  draftFailed = false;
  writing = null;
  again = null;

  constructor(session, data) {
    const [rows, columns] = session.track.grid;
    this.session = session;
    this.say = say;
    this.failed = failed;
    this.newTrack = (cues) => new Track(rows, columns, cues);
    this.history = new History(this.newTrack(data.cues));
    this.sync = new Sync(this.history, { page: desk.page, send: desk.send, revision: data.revision,
      saved: data.saved, name: session.track.path });
    new UndoStore(this.history, session.track.path);
    this.limits = new Limits(this.history.track, session.limits);
    this.film = new Film($('video'), session.film);
    this.transport = new Transport(this.film, () => this.timeline.focus());
    this.timeline = new Timeline($('timeline'), { history: this.history, film: session.film });
    this.strip = new Strip(this.timeline);
    this.grid = new Grid($('cells'), this.film, session.track);
    this.feel = new Feel(this.film, desk.page, columns, (ms) => this.history.track.at(ms));
    this.table = new CueTable($('cue-table'), { history: this.history });
    this.tabs = new Tabs($('tabs'));
    this.panel = new Panel(this);
    this.review = new Review($('review'), this);
    document.title = `${session.track.name} – Desk`;
    $('title').textContent = `${session.film.name} – ${session.track.name}`;
    const { width, height } = session.film;
    if (width && height)
      document.querySelector('main').style.setProperty('--ratio', width / height);
    for (const text of session.messages)
      (text.endsWith('restored from the journal') ? tell : fail)(text);
    this.#listen();
    this.layout = new Layout(() => this.#showTime());
    new Toolbar(this.timeline);
    new Minimap($('minimap'), this.timeline);
    this.#showWriter();
    this.#changed({ from: 0, to: this.history.track.end });
    if (session.review)
      this.toggleReview();
  }

  #listen() {
    const { film, grid, history, sync, timeline, table } = this;
    history.addEventListener('change', ({ detail }) => this.#changed(detail));
    sync.addEventListener('state', () => this.#showSync());
    for (const name of ['time', 'state', 'leap'])
      film.addEventListener(name, () => this.#showTime());
    film.addEventListener('fail', ({ detail }) => fail(detail));
    timeline.addEventListener('seek', ({ detail }) => film.seek(detail.ms));
    timeline.addEventListener('select', () => this.panel.show());
    timeline.addEventListener('loop', ({ detail }) => this.setLoop(detail.loop));
    timeline.addEventListener('level', ({ detail }) => this.setLevel(detail.level));
    table.addEventListener('seek', ({ detail }) => film.seek(detail.ms));
    table.addEventListener('select', ({ detail }) => {
      timeline.selection = detail.selection;
      this.panel.show();
    });
    grid.addEventListener('paint', ({ detail }) => {
      history.do(paint(history.track, detail), { label: 'Paint' });
    });
    grid.addEventListener('press', ({ detail }) => this.feel.brief(detail.levels, 300));
    choiceForm($('operations'), 'Operation', OPERATIONS, (kind, values) => this.#operate(kind, values));
    this.#bind();
    $('cue-table').closest('details').addEventListener('toggle', () => this.#showTime());
    window.addEventListener('keydown', (event) => this.#key(event));
    window.addEventListener('beforeunload', (event) => {
      if (sync.pending)
        event.preventDefault();
    });
  }

  #bind() {
    const click = (id, act) => $(id).addEventListener('click', act);
    click('undo', () => this.undo());
    click('redo', () => this.redo());
    click('save', () => this.save());
    click('review-toggle', () => this.toggleReview());
    click('help-open', () => this.#help());
    click('take-over', () => this.write(true).catch(failed));
    click('loop', () => this.setLoop(this.film.loop ? null : this.timeline.selection, true));
    click('show-map', () => this.#toggleMap());
    click('record', () => this.#record());
    // A form that was applied by Enter in a field gives the keyboard back.
    window.addEventListener('applied', () => {
      if (document.activeElement?.matches('input'))
        this.timeline.focus();
    });
    $('level').addEventListener('input', () => this.setLevel(Number($('level').value)));
    $('feel-pad').addEventListener('change', () => {
      this.feel.pad.enabled = $('feel-pad').checked;
      this.feel.pad.stop();
    });
    $('feel-chair').addEventListener('change', () => this.#showWriter());
    for (const name of ['gamepadconnected', 'gamepaddisconnected'])
      window.addEventListener(name, () => this.#showPad());
    this.#showPad();
    this.setLevel(this.timeline.level ?? 75);
    rememberSingleKeys($('single-keys'));
  }

  /**
   * Asks to write; whoever writes gets the newest track first. One attempt at a time: what is asked
   * during one is asked again after a refusal, as the seat may have become free meanwhile.
   */
  write(take) {
    this.again = this.writing ? { take: take || (this.again?.take ?? false) } : null;
    this.writing ??= this.#write(take).finally(() => { this.writing = null; });
    return this.writing;
  }

  async #write(take) {
    let { writer } = await desk.post('writer', { take });
    while (!writer && this.again) {
      const again = this.again;
      this.again = null;
      ({ writer } = await desk.post('writer', again));
    }
    if (!writer) {
      this.setWriter(this.writer);
      return;
    }
    await this.load();
    const { sent } = await this.sync.recover();
    if (sent) {
      await this.load();
      tell(`This browser had edits that it had not sent: ${sent}. They are restored.`);
    }
    if (this.sync.kept.length)
      offerKept(this.sync, 'Edits that the desk did not take are kept in this browser.');
    this.setWriter(desk.page);
    this.sync.retry();
  }

  /** The track as the desk has it, which may be another one. */
  async load() {
    const data = await desk.get('track');
    this.sync.reload(this.newTrack(data.cues), data.revision, data.saved);
  }

  /** @param {string|null} writer the page that writes */
  setWriter(writer) {
    this.writer = writer;
    this.readOnly = writer !== desk.page;
    $('reader-text').textContent = writer
      ? 'This page only reads: another page edits this track.'
      : 'This page only reads: no page edits this track now.';
    this.#showWriter();
  }

  #showWriter() {
    const { readOnly } = this;
    $('reader').hidden = !readOnly;
    this.timeline.readOnly = this.grid.readOnly = readOnly;
    this.feel.chair = !readOnly && $('feel-chair').checked;
    for (const id of ['save', 'record'])
      $(id).disabled = readOnly;
    for (const control of document.querySelectorAll('.options button'))
      control.disabled = readOnly;
    if (readOnly && this.grid.recording)
      this.#record();
    this.panel.show();
    this.review.show();
    this.#showHistory();
    this.#showSync();
  }

  #changed({ from, to, kind, label }) {
    if (kind === 'reset')
      this.limits.reset(this.history.track);
    else
      this.limits.update(from, to);
    this.timeline.warnings = this.limits.warnings;
    showWarnings(this.limits.warnings, (warning) => {
      this.film.pause();
      this.film.seek(warning.start);
      const cells = warning.cell < 0 ? undefined : [warning.cell];
      this.timeline.selection = { from: warning.start, to: warning.end, cells };
      this.timeline.reveal(warning.start);
      this.panel.show();
    });
    if (kind === 'undo' || kind === 'redo')
      say(`${kind === 'undo' ? 'Undone' : 'Redone'}: ${label}`);
    this.panel.show();
    this.review.show();
    this.#showHistory();
    this.#showTime();
  }

  #showHistory() {
    for (const [id, name] of [['undo', 'Undo'], ['redo', 'Redo']]) {
      const label = this.history[`${id}Label`];
      $(id).disabled = !label || this.readOnly;
      $(id).title = label ? `${name}: ${label}` : '';
    }
  }

  #showSync() {
    const { state, text } = this.sync;
    $('save-state').textContent = this.readOnly ? 'Read only' : text;
    $('save-state').dataset.state = state;
    if (state === 'reader' && !this.readOnly)
      this.setWriter(null);
    if ((state === 'conflict' || state === 'refused') && !this.reloading)
      this.#reload().catch(failed);
  }

  async #reload() {
    this.reloading = true;
    const why = this.sync.text;
    try {
      await this.load();
      offerKept(this.sync, `${why}. The desk's track was loaded again.`);
    } finally {
      this.reloading = false;
    }
  }

  #showTime() {
    const { film, grid, timeline, table } = this;
    const { position } = film;
    timeline.follow = !film.paused;
    timeline.playhead = position;
    if ($('cue-table').closest('details').open)
      table.playhead = position;
    const levels = this.#shown(position);
    grid.show(levels);
    drawMap($('overlay'), this.history.track.rows, this.history.track.columns, levels);
    this.transport.show();
  }

  /** The track's map, with what is just being painted. */
  #shown(position) {
    const levels = [...this.history.track.at(position)];
    for (const [cell, { level }] of this.grid.recorder.held)
      levels[cell] = level;
    return levels;
  }

  #showPad() {
    const { gamepad } = this.feel.pad;
    $('pad-state').textContent = gamepad ? gamepad.id : 'none yet: press a button on it';
  }

  setLevel(level) {
    if (!level)
      return;
    this.grid.level = this.timeline.level = level;
    $('level').value = level;
    $('level-value').textContent = `${level} %`;
  }

  setLoop(loop, byButton = false) {
    if (byButton) {
      if (!loop && !this.film.loop)
        tell('Select the time to be looped first: in the timeline, by Enter or by I and O.');
      this.timeline.loop = loop && { from: loop.from, to: loop.to };
    }
    this.film.loop = loop && { from: loop.from, to: loop.to };
    say(loop ? `Loop: ${formatTime(loop.from)} to ${formatTime(loop.to)}` : 'Loop off');
    this.#showTime();
  }

  /** For the review: a change is selected and played again and again. */
  play(from, to) {
    this.timeline.selection = { from, to };
    this.timeline.reveal(from);
    this.setLoop({ from: Math.max(0, from - 500), to: Math.min(this.film.duration || Infinity, to + 500) }, true);
    this.panel.show();
    this.film.seek(Math.max(0, from - 500));
    this.film.play();
  }

  undo() { if (!this.readOnly) this.history.undo(); }
  redo() { if (!this.readOnly) this.history.redo(); }

  async save(over = false) {
    if (this.readOnly)
      return;
    try {
      const { path, kept } = await this.sync.save({ over });
      say(`Saved ${path}${kept ? `; what was there is now ${kept}` : ''}`);
    } catch (thrown) {
      if (thrown.changed)
        offerSaveOver(this.session.track.name, () => this.save(true));
      else
        failed(thrown);
    }
  }

  async #operate(kind, values) {
    const body = request(kind, values, this.timeline.selection);
    if (this.readOnly)
      throw new Hint('This page only reads. Take over first.');
    if (kind.draft && !this.draft)
      throw new Hint('The automatic draft is not there yet. Try again when it has been made.');
    if (this.sync.pending)
      throw new Hint('Edits are still on their way to the desk. Try again in a moment.');
    const { fingerprint } = this.history.track;
    const { splices } = await desk.post('operation', { revision: this.sync.revision, ...body });
    if (this.readOnly || this.history.track.fingerprint !== fingerprint)
      throw new Hint('The track has changed meanwhile. Try again.');
    this.history.do(splices, { label: kind.label });
    say(splices.length ? `Done: ${kind.label}` : `${kind.label}: nothing to change`);
  }

  #record() {
    const { grid } = this;
    grid.recording = !grid.recording && !this.readOnly;
    if (!grid.recording)
      grid.recorder.stop(this.film.position);
    $('record').setAttribute('aria-pressed', grid.recording);
    $('grid-hint').textContent = grid.recording
      ? 'Hold cells, by mouse, by 1–9 or by the gamepad, while the film plays. While it stands, a press is one map.'
      : 'A press is felt. Record (R) paints it.';
    say(grid.recording ? 'Recording' : 'Recording off');
  }

  #toggleMap() {
    const shown = $('overlay').hidden;
    $('overlay').hidden = !shown;
    $('show-map').setAttribute('aria-pressed', shown);
    this.#showTime();
  }

  toggleReview() {
    const shown = $('review').hidden;
    $('review').hidden = !shown;
    document.body.classList.toggle('reviewing', shown);
    $('review-toggle').setAttribute('aria-pressed', shown);
    this.review.show();
    this.timeline.refresh();
    this.#showTime();
  }

  #help() {
    $('help-keys').replaceChildren(...keyTables());
    if (!$('help').open)
      $('help').showModal();
  }

  #key(event) {
    if (event.defaultPrevented || $('help').open)
      return;
    const found = commandOf(event, $('single-keys').checked);
    if (!found)
      return;
    const { command, by } = found;
    const inTimeline = $('timeline').contains(event.target);
    if (inTimeline && ['undo', 'redo'].includes(command))
      return;
    const commands = {
      play: () => this.film.toggle(),
      step: () => this.film.step(by),
      rate: () => this.transport.changeRate(by),
      cell: () => {
        const cell = this.grid.cellOf(event);
        if (cell !== null)
          this.grid.key(event, cell);
      },
      record: () => this.#record(),
      mute: () => this.transport.toggleSound(),
      map: () => this.#toggleMap(),
      review: () => this.toggleReview(),
      timeline: () => this.timeline.focus(),
      time: () => this.transport.focus(),
      full: () => this.layout.toggleFull(),
      panel: () => {
        this.tabs.show($('selection'));
        $('selection').elements.start.focus();
      },
      undo: () => this.undo(),
      redo: () => this.redo(),
      save: () => this.save(),
      help: () => this.#help(),
    };
    event.preventDefault();
    if (!event.repeat || command === 'step' || command === 'undo' || command === 'redo')
      commands[command]();
  }

  /** Server-sent events. */
  handlers() {
    let strip = -1;
    return {
      // This page writes only once write() has loaded the newest track.
      writer: ({ writer }) => {
        if (writer === desk.page)
          this.writer = writer;
        else
          this.setWriter(writer);
        if (writer === null)
          this.write(false).catch(failed);
      },
      revision: ({ revision }) => {
        if (this.readOnly && revision !== this.sync.revision)
          this.load().catch(failed);
      },
      progress: (progress) => {
        if (progress.strip !== strip && progress.strip !== null) {
          strip = progress.strip;
          this.strip.update().catch(failed);
        }
        if (progress.draft === 1 && !this.draft)
          this.#loadDraft().catch(failed);
        if (progress.draft === null && !this.draftFailed) {
          this.draftFailed = true;
          this.review.show();
        }
      },
      chair: ({ state, text }) => { $('chair-state').textContent = text || state; },
      lost: (text) => fail(text),
      back: () => {
        for (const item of [...$('alerts').children]) {
          if (item.textContent.startsWith('The desk cannot be reached'))
            item.remove();
        }
        say('The desk answers again');
        this.write(false).catch(failed);
      },
    };
  }

  async #loadDraft() {
    const { cues } = await desk.get('draft');
    this.draft = this.newTrack(cues);
    this.timeline.draft = this.draft;
    this.timeline.refresh();
    this.review.show();
  }
}

async function start() {
  const [session, data] = await Promise.all([desk.get('session'), desk.get('track')]);
  const page = new Page(session, data);
  await desk.listen(page.handlers());
  await page.write(false);
  page.timeline.focus();
  document.body.dataset.ready = 'true';
}

start().catch(failed);
