// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A film plays: offer.js looks whether it has a track.
document.addEventListener("playing", () => chrome.runtime?.sendMessage({ playing: true }), true);
