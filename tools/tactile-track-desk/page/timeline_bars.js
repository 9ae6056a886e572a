// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * The events of the timeline as an image, so that how much is drawn does not grow with the time in
 * view: a pixel in which there are several cues has the strongest.
 */
import { GUTTER } from './timeline_view.js';

export class TimelineBars {
  #canvas = document.createElement('canvas');
  #context = this.#canvas.getContext('2d', { willReadFrequently: true });
  #image = null;
  #pixels = null; // the image's, a number each
  #levels = new Uint8Array(0);

  /**
   * Draws tracks, the first ones behind.
   * @param {CanvasRenderingContext2D} context in CSS pixels
   * @param {import('./timeline_view.js').TimelineView} view
   * @param {number} ratio device pixels a CSS pixel
   * @param {[import('./track.js').Track, string][]} tracks with their colors
   */
  draw(context, view, ratio, tracks) {
    const width = Math.ceil(view.span * ratio);
    const top = Math.round(view.rowsTop * ratio);
    const height = Math.max(Math.round(view.height * ratio) - top, 1);
    this.#resize(width, height);
    const [first, last] = view.visibleCells;
    for (const [track, color] of tracks) {
      this.#read(track, view, ratio, first, last, width);
      const pixel = this.#pixelOf(color);
      for (let cell = first; cell < last; cell++) {
        const [y, least] = view.bar(cell, 0);
        const bottom = Math.round((y + least) * ratio) - top;
        this.#row((cell - first) * width, bottom, view.barRoom * ratio, pixel);
      }
    }
    this.#context.putImageData(this.#image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#canvas, GUTTER, top / ratio, width / ratio, height / ratio);
    context.imageSmoothingEnabled = true;
  }

  #resize(width, height) {
    if (this.#image?.width === width && this.#image.height === height) {
      this.#pixels.fill(0);
      return;
    }
    Object.assign(this.#canvas, { width, height });
    this.#image = new ImageData(width, height);
    this.#pixels = new Uint32Array(this.#image.data.buffer);
  }

  #pixelOf(color) {
    this.#context.fillStyle = color;
    this.#context.fillRect(0, 0, 1, 1);
    return new Uint32Array(this.#context.getImageData(0, 0, 1, 1).data.buffer)[0];
  }

  /** The strongest level of each cell in each pixel. */
  #read(track, view, ratio, firstCell, lastCell, width) {
    const size = width * (lastCell - firstCell);
    if (this.#levels.length < size) this.#levels = new Uint8Array(size);
    const levels = this.#levels.fill(0);
    const [first, last] = track.range(Math.floor(view.from), Math.ceil(view.to));
    const scale = ratio / view.scale;
    for (let i = first; i < last; i++) {
      const cue = track.cues[i];
      const from = Math.max(Math.round((cue.start - view.from) * scale), 0);
      const to = Math.min(Math.max(Math.round((cue.end - view.from) * scale), from + 1), width);
      for (let cell = firstCell, row = 0; cell < lastCell; cell++, row += width) {
        const level = cue.levels[cell];
        if (level === 0) continue;
        for (let x = row + from; x < row + to; x++) if (levels[x] < level) levels[x] = level;
      }
    }
  }

  /** Bars that end above the line `bottom`, as high as view.bar() says, at least 2. */
  #row(row, bottom, room, pixel) {
    const [levels, pixels] = [this.#levels, this.#pixels];
    const { width, height } = this.#image;
    for (let up = 1; up <= Math.ceil(room); up++) {
      const y = bottom - up;
      if (y < 0 || y >= height) continue;
      const least = up <= 2 ? 1 : Math.ceil((up - 0.5) * 100 / room);
      if (least > 100) break;
      for (let x = 0, at = y * width; x < width; x++, at++) if (levels[row + x] >= least) pixels[at] = pixel;
    }
  }
}
