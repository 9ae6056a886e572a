// SPDX-License-Identifier: LGPL-2.1-or-later
//
// By itself, Chromium tells the session bus a film's position to 100 ms. This tells it by the frames
// that are shown, wherever that is off by more than their jitter.
(() => {
    "use strict";

    const LATER = 0.06; // s that visuotactile-follow expects Chromium's picture to be behind its position
    const FRAMES = 12; // by whose median is known where the film is
    const MOST = 0.008; // s: what is off by more is told again
    const session = navigator.mediaSession;
    const setPositionState = session.setPositionState.bind(session);

    function tell(film, position) {
        if (!(film.duration > 0 && film.duration < Infinity))
            return; // nothing is told of what is live
        session.playbackState = film.paused ? "paused" : "playing";
        setPositionState({
            duration: film.duration,
            playbackRate: film.playbackRate,
            position: Math.min(Math.max(position + LATER, 0), film.duration),
        });
    }

    function follow(film) {
        let offsets = []; // s that the film is ahead of the clock, by the last frames
        let told = null; // of these

        function shown(_now, frame) {
            film.requestVideoFrameCallback(shown);
            const rate = film.playbackRate;
            if (film.paused || film.seeking || film.muted || !(rate > 0))
                return;
            offsets = [...offsets.slice(1 - FRAMES), frame.mediaTime - rate * frame.expectedDisplayTime / 1000];
            const offset = offsets.toSorted((a, b) => a - b)[offsets.length >> 1];
            if (offsets.length < FRAMES || (told !== null && Math.abs(offset - told) < MOST))
                return;
            told = offset;
            tell(film, offset + rate * performance.now() / 1000);
        }

        film.requestVideoFrameCallback(shown);
        for (const event of ["playing", "pause", "seeked", "ratechange"])
            film.addEventListener(event, () => {
                offsets = [];
                told = null;
                if (film.paused && !film.muted)
                    tell(film, film.currentTime);
            });
        session.setPositionState = () => {}; // what the page itself tells is less exact
    }

    const followed = new WeakSet();
    document.addEventListener("playing", ({ target: film }) => {
        if (!(film instanceof HTMLVideoElement) || followed.has(film))
            return;
        followed.add(film);
        follow(film);
    }, true);
})();
