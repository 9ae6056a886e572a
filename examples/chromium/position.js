// SPDX-License-Identifier: LGPL-2.1-or-later
//
// By itself, Chromium tells the session bus a film's position to 100 ms. This tells it by the frames
// that are shown. Where these do not say it, Chromium's own position counts.
(() => {
    "use strict";

    const LATER = 0.06; // s that visuotactile-follow expects Chromium's picture to be late (lib/follow/players/mpris_player.cpp)
    const FRAMES = 12; // by whose median is known where the film is
    const MOST = 0.008; // s: what is off by more is told again
    const session = navigator.mediaSession;
    const setPositionState = session.setPositionState.bind(session);
    let current = null; // the film that was started last, of those that are heard
    let offsets = []; // s that it is ahead of the clock, by its last frames
    let told = null; // of these; none: Chromium's own position counts

    function withdraw() {
        offsets = [];
        if (told !== null)
            setPositionState();
        told = null;
    }

    function choose(film) {
        withdraw();
        current = film;
    }

    function shown(film, frame) {
        const rate = film.playbackRate;
        if (film !== current || film.paused || film.seeking || !(rate > 0 && film.duration > 0 && film.duration < Infinity))
            return;
        offsets = [...offsets.slice(1 - FRAMES), frame.mediaTime - rate * frame.expectedDisplayTime / 1000];
        const offset = offsets.toSorted((a, b) => a - b)[offsets.length >> 1];
        if (offsets.length < FRAMES || (told !== null && Math.abs(offset - told) < MOST))
            return;
        told = offset;
        const position = offset + rate * performance.now() / 1000 + LATER;
        setPositionState({ duration: film.duration, playbackRate: rate, position: Math.min(Math.max(position, 0), film.duration) });
    }

    function follow(film) {
        film.requestVideoFrameCallback(function each(_now, frame) {
            film.requestVideoFrameCallback(each);
            shown(film, frame);
        });
        for (const event of ["pause", "seeking", "ratechange", "waiting", "ended", "emptied"])
            film.addEventListener(event, () => {
                if (film === current)
                    withdraw();
            });
        film.addEventListener("volumechange", () => {
            if (film.muted && film === current)
                choose(null);
            else if (!film.muted && !film.paused && film !== current)
                choose(film);
        });
    }

    // What the page itself tells is less exact.
    session.setPositionState = (...state) => {
        if (told === null)
            setPositionState(...state);
    };

    const followed = new WeakSet();
    document.addEventListener("playing", ({ target: film }) => {
        if (!(film instanceof HTMLVideoElement))
            return;
        if (!followed.has(film))
            follow(film);
        followed.add(film);
        if (!film.muted)
            choose(film);
    }, true);
})();
