// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Whether the film that plays has a track, and the way to one: host.py asks visuotactile-follow, and makes it.
"use strict";

const HOST = "org.visuotactile.offer";
const FOUND = 3000; // ms after which visuotactile-follow has found a track, if there is one

function show(text, title) {
    chrome.action.setBadgeText({ text });
    chrome.action.setTitle({ title });
}

async function look() {
    try {
        const { film, track } = await chrome.runtime.sendNativeMessage(HOST, { ask: "status" });
        if (film && !track)
            show("+", `No track for “${film}”: make one`);
        else
            show("", "Visuotactile");
    } catch {
        // Without the host there is no offer; the button says how to install it.
    }
}

// The button's page closes when the file is chosen, so that this one listens to the host.
function make() {
    const port = chrome.runtime.connectNative(HOST);
    port.onMessage.addListener(({ text, badge }) => {
        show(badge, text);
        chrome.runtime.sendMessage({ text }).catch(() => {}); // the button's page may be closed
        if (badge !== "…")
            port.disconnect();
    });
    port.postMessage({ ask: "make" });
}

chrome.runtime.onMessage.addListener(({ playing, wanted }) => {
    if (playing)
        setTimeout(look, FOUND);
    if (wanted)
        make();
});
