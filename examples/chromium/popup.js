// SPDX-License-Identifier: LGPL-2.1-or-later
"use strict";

const text = document.getElementById("text");
const button = document.getElementById("make");

function told({ film, track, library, runs }) {
    if (!runs)
        return "visuotactile-follow does not run. Start it first.";
    if (!film)
        return "No film plays.";
    if (track)
        return `“${film}” is felt: ${track}.`;
    button.hidden = !library;
    return `There is no track for “${film}”.` + (library ? "" : " Start visuotactile-follow with --tracks=FOLDER to keep one.");
}

chrome.runtime.sendNativeMessage("org.visuotactile.offer", { ask: "status" }).then(
    (status) => { text.textContent = told(status); },
    () => { text.textContent = "To make tracks from here, run “host.py --install” in the extension’s folder once."; });
button.addEventListener("click", () => {
    button.hidden = true;
    chrome.runtime.sendMessage({ wanted: true });
});
chrome.runtime.onMessage.addListener((message) => {
    if (message.text)
        text.textContent = message.text;
});
