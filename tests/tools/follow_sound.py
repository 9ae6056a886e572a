#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How much later than its picture a real player's sound comes: tones at PulseAudio's null sink against frames on Xvfb's screen, both of which are of the
same times of a film. Prints a line of a table: the median after the start, a pause and a seek.

Usage: follow_sound.py PLAYER [SECONDS]      PLAYER: mpv, vlc, kodi, chromium or chromium-extended; SECONDS: of each stretch (default: 20), from 3 s after its event on"""

import collections
import os
import pathlib
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time

from follow_players import PLAYERS, Bus
from follow_screen import Screen, make_film
from null_sink import RATE, NullSink

PLAYER = PLAYERS[sys.argv[1]]
SECONDS = float(sys.argv[2]) if len(sys.argv) > 2 else 20
SETTLING = 3  # s
LOUD = 3000  # of 32767
LATENCY = 5  # ms: the sink makes so much sound at once


class Ear:
    """Hears a sound server. Sound that is made at once arrives when the first of it is heard, so that tones are known to LATENCY."""

    def __init__(self, sound):
        self.listener = subprocess.Popen(["parec", f"--server=unix:{sound.socket}", "--device=null.monitor", "--format=s16le", f"--rate={RATE}", "--channels=1",
                                          "--raw", f"--latency-msec={LATENCY}"], stdout=subprocess.PIPE, bufsize=0)
        self.tones = []  # when they begin
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        heard, quiet_since = 0, 0
        begins = collections.deque(maxlen=200)  # of the stream, as by each piece of sound
        while piece := os.read(self.listener.stdout.fileno(), 1 << 16):
            begins.append(time.monotonic() - heard / RATE)
            samples = struct.unpack(f"<{len(piece) // 2}h", piece[:len(piece) // 2 * 2])
            for i, sample in enumerate(samples):
                if abs(sample) > LOUD:
                    if heard + i - quiet_since > RATE // 4:
                        self.tones.append(statistics.median(begins) + (heard + i) / RATE)
                    quiet_since = heard + i
            heard += len(samples)

    def stop(self):
        self.listener.kill()
        self.listener.wait()


class Stage:
    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-sound-"))
        self.folder.chmod(0o755)
        self.bus, self.screen, self.sound = Bus(self.folder), Screen(self.folder), NullSink(self.folder)
        self.ear = Ear(self.sound)

    def stop(self):
        for part in (self.ear, self.sound, self.screen, self.bus):
            part.stop()
        shutil.rmtree(self.folder)


def later(stage, begin, end):
    """How much later than the pictures of their times the tones came, in ms."""
    found = []
    for tone in list(stage.ear.tones):
        frames = stage.screen.known(tone - 0.5, tone + 0.5)
        if begin < tone < end and len(frames) >= 8:
            position = statistics.median(at + tone - time for time, at in frames)
            found.append(1000 * (position - round(position)))
    return found


def pause_and_play(player):
    player.pause()
    time.sleep(1)
    player.play()


def main():
    stage = Stage()
    player = None
    try:
        make_film(stage.folder / "film.mkv", int(3 * (SECONDS + SETTLING)) + 60)
        player = PLAYER(stage.folder / "film.mkv", stage)
        found = []
        for begin in (lambda: player.play(), lambda: pause_and_play(player), lambda: player.seek(10.65)):
            begin()
            since = time.monotonic() + SETTLING
            time.sleep(SETTLING + SECONDS + 1)
            found.append(later(stage, since, since + SECONDS))
            assert len(found[-1]) > SECONDS / 2, (f"{len(found[-1])} tones with pictures in {SECONDS} s, of {len(stage.ear.tones)} tones and "
                                                  f"{len(stage.screen.frames)} frames")
        print(f"| {sys.argv[1]} | " + " | ".join(f"{statistics.median(of):+.0f} ms" for of in found) + f" | {min(map(min, found)):+.0f} to {max(map(max, found)):+.0f} ms |")
    finally:
        if player:
            player.kill()
        stage.stop()


main()
