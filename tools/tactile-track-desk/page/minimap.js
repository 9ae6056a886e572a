// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * The whole film above the timeline: how strong it is at each time, warnings, and what the timeline shows.
 * A drag, or arrow keys, moves that.
 */
import { formatTime } from './time.js';

export class Minimap {
  #canvas;
  #timeline;
  #whole = document.createElement('canvas'); // without what moves
  #drawn = []; // of what it was made

  /**
   * @param {HTMLCanvasElement} canvas with role scrollbar
   * @param {import('./timeline.js').Timeline} timeline
   */
  constructor(canvas, timeline) {
    this.#canvas = canvas;
    this.#timeline = timeline;
    timeline.addEventListener('drawn', () => this.#draw());
    timeline.history.addEventListener('change', () => { this.#drawn = []; });
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.#center(event);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (canvas.hasPointerCapture(event.pointerId))
        this.#center(event);
    });
  }

  #center({ offsetX }) {
    const { view, length } = this.#timeline;
    this.#move(offsetX / this.#canvas.clientWidth * length - (view.to - view.from) / 2);
  }

  #move(from) {
    const { view } = this.#timeline;
    view.pan((from - view.from) / view.scale);
    this.#timeline.moved();
  }

  #key(event) {
    const { view, length } = this.#timeline;
    const page = view.to - view.from;
    const to = { ArrowLeft: view.from - page / 10, ArrowRight: view.from + page / 10, PageUp: view.from - page,
      PageDown: view.from + page, Home: 0, End: length }[event.key];
    if (to === undefined)
      return;
    event.preventDefault();
    this.#move(to);
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width)
      return;
    const { view, length, playhead, painter: { colors } } = this.#timeline;
    const x = (ms) => ms / length * width;
    this.#drawWhole(width, height);
    Object.assign(this.#canvas, { width, height });
    const context = this.#canvas.getContext('2d');
    context.drawImage(this.#whole, 0, 0);
    context.strokeStyle = colors.selection;
    context.lineWidth = 2;
    context.strokeRect(x(view.from) + 1, 1, Math.max(x(Math.min(view.to, length) - view.from), 4) - 2, height - 2);
    context.fillStyle = colors.playhead;
    context.fillRect(x(playhead), 0, 2, height);
    for (const [name, value] of [['valuenow', Math.round(view.from / length * 100)], ['valuemin', 0], ['valuemax', 100],
      ['valuetext', `${formatTime(view.from)} to ${formatTime(view.to)}`]])
      if (this.#canvas.getAttribute(`aria-${name}`) !== `${value}`)
        this.#canvas.setAttribute(`aria-${name}`, value);
  }

  #drawWhole(width, height) {
    const { draft, warnings, length, history: { track }, painter: { colors } } = this.#timeline;
    const now = [width, height, length, draft, warnings, track, colors];
    if (now.every((one, i) => one === this.#drawn[i]))
      return;
    this.#drawn = now;
    Object.assign(this.#whole, { width, height });
    const context = this.#whole.getContext('2d');
    context.fillStyle = colors.row;
    context.fillRect(0, 0, width, height);
    for (const [each, color] of [[draft, colors.draft], [track, colors.event]]) {
      context.fillStyle = color;
      strongest(each, length, width).forEach((level, x) => {
        const high = Math.ceil(level / 100 * (height - 5));
        context.fillRect(x, height - 3 - high, 1, high);
      });
    }
    context.fillStyle = colors.warning;
    for (const { start, end } of warnings)
      context.fillRect(start / length * width, height - 3, Math.max((end - start) / length * width, 2), 3);
  }
}

/** The strongest level in each pixel. */
function strongest(track, length, width) {
  const levels = new Uint8Array(width);
  for (const cue of track?.cues ?? []) {
    const level = Math.max(...cue.levels);
    const last = Math.min(Math.ceil(cue.end / length * width), width);
    for (let x = Math.floor(cue.start / length * width); x < last; x++)
      levels[x] = Math.max(levels[x], level);
  }
  return levels;
}
