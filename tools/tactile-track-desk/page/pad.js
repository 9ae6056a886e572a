// SPDX-License-Identifier: LGPL-2.1-or-later

const EFFECT = 250; // ms: how long a rumble lasts that nothing renews
const RENEWED = 120; // ms

/**
 * What a gamepad's two motors play of a map, as tactorsink's gamepad driver does: of each half the
 * strongest cell counts, and the middle column of an odd number belongs to the left.
 * @param {number[]} levels percent, row by row
 * @param {number} columns
 * @returns {{strong: number, weak: number}} 0 to 1; the strong motor is in the left grip
 */
export function rumble(levels, columns) {
  const most = { strong: 0, weak: 0 };
  levels.forEach((level, cell) => {
    const side = cell % columns < Math.ceil(columns / 2) ? 'strong' : 'weak';
    most[side] = Math.max(most[side], level / 100);
  });
  return most;
}

/**
 * The gamepad in the hand, by the Gamepad API. It is at zero unless play() is called again and
 * again, and at once when the page is hidden or loses the focus.
 */
export class Pad {
  #last = { strong: 0, weak: 0 };
  #sent = -Infinity; // ms, performance.now()

  constructor() {
    this.enabled = true;
    for (const name of ['blur', 'pagehide'])
      window.addEventListener(name, () => this.stop());
    document.addEventListener('visibilitychange', () => document.hidden && this.stop());
  }

  /** The first gamepad that has motors, or null. A browser shows none before a button is pressed. */
  get gamepad() {
    return navigator.getGamepads().find((pad) => pad?.connected && pad.vibrationActuator) ?? null;
  }

  /** Plays a map until the next call, for 250 ms at most. */
  play(levels, columns) {
    if (!this.enabled || document.hidden || !document.hasFocus())
      return;
    const now = performance.now();
    const next = rumble(levels, columns);
    const same = next.strong === this.#last.strong && next.weak === this.#last.weak;
    if (same && (now - this.#sent < RENEWED || next.strong + next.weak === 0))
      return;
    const { gamepad } = this;
    if (!gamepad)
      return;
    this.#last = next;
    this.#sent = now;
    // Another effect replaces this one, which is no error.
    gamepad.vibrationActuator.playEffect('dual-rumble', {
      startDelay: 0, duration: EFFECT, strongMagnitude: next.strong, weakMagnitude: next.weak,
    }).catch(() => {});
  }

  stop() {
    this.#last = { strong: 0, weak: 0 };
    this.#sent = -Infinity;
    for (const pad of navigator.getGamepads())
      pad?.vibrationActuator?.reset().catch(() => {});
  }
}
