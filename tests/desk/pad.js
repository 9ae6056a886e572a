// SPDX-License-Identifier: LGPL-2.1-or-later
// A gamepad for a page, put into it before its own scripts: `pad` has its sticks and buttons, and
// `rumbles` what it was told to play.
window.rumbles = [];
window.pad = {
  id: 'Pad of a test', index: 0, connected: true, mapping: 'standard', axes: [0, 0, 0, 0],
  buttons: Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 })),
  vibrationActuator: {
    playEffect(kind, { duration, strongMagnitude: strong, weakMagnitude: weak }) {
      window.rumbles.push({ kind, duration, strong, weak });
      return Promise.resolve('complete');
    },
    reset() {
      window.rumbles.push({ kind: 'reset', strong: 0, weak: 0 });
      return Promise.resolve('complete');
    },
  },
};
navigator.getGamepads = () => [window.pad, null, null, null];
