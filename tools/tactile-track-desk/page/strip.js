// SPDX-License-Identifier: LGPL-2.1-or-later
import * as desk from './desk.js';

const KEPT = 400; // thumbnails in memory

/** What is seen and heard of the film behind the timeline, as far as the desk has got. */
export class Strip {
  #timeline;
  #strip = null;
  #images = new Map(); // by index; the newest last
  #sound = [];
  #loading = false;

  constructor(timeline) {
    this.#timeline = timeline;
  }

  /** More of it may be there. */
  async update() {
    if (this.#loading)
      return;
    this.#loading = true;
    try {
      const [strip, peaks, cuts] = await Promise.all([desk.get('thumbnails'),
        desk.bytes(`sound?from=${this.#sound.length}`), desk.get('cuts')]);
      // A picture nearby gives way to that of the moment.
      for (let index = this.#strip?.final ?? 0; index < strip.final; index++)
        this.#images.delete(index);
      this.#strip = strip;
      this.#timeline.impacts = cuts.impacts;
      this.#timeline.cuts = cuts.cuts;
      if (peaks.length) {
        this.#sound = this.#joined(peaks);
        this.#timeline.peaks = this.#sound;
      }
      this.#timeline.setStrip(strip, (index) => this.#image(index));
      this.#timeline.refresh();
    } finally {
      this.#loading = false;
    }
  }

  #joined(peaks) {
    const all = new Uint8Array(this.#sound.length + peaks.length);
    all.set(this.#sound);
    all.set(peaks, this.#sound.length);
    return all;
  }

  #image(index) {
    if (index >= this.#strip.count)
      return null;
    const known = this.#images.get(index);
    if (known)
      return known.complete && known.naturalWidth ? known : null;
    const image = new Image();
    image.onload = () => this.#timeline.refresh();
    image.onerror = () => this.#images.delete(index);
    image.src = `thumbnail?index=${index}${index < this.#strip.final ? '' : '&near=1'}`;
    this.#images.set(index, image);
    if (this.#images.size > KEPT)
      this.#images.delete(this.#images.keys().next().value);
    return null;
  }
}
