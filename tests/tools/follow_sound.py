#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How much later than its picture a real player's sound comes: tones at PulseAudio's null sink against frames on Xvfb's screen, both of which are of the
same times of a film. Prints a line of a table: the median after the start, a pause and a seek.

Usage: follow_sound.py PLAYER [SECONDS]      PLAYER: mpv, vlc, kodi or chromium; SECONDS: of each stretch (default: 20), from 3 s after its event on"""

import collections
import contextlib
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
from follow_screen import RATE, Screen, make_film
from pulse_clock import appears

PLAYER = PLAYERS[sys.argv[1]]
SECONDS = float(sys.argv[2]) if len(sys.argv) > 2 else 20
SETTLING = 3  # s
SAMPLES = 48000  # a second
LOUD = 3000  # of 32767
LATENCY = 5  # ms: the sink makes so much sound at once
SINK = f"module-null-sink sink_name=null rate={SAMPLES} channels=2"


class Ear:
    """Hears PulseAudio's null sink. Sound that is made at once arrives when the first of it is heard, so that tones are known to LATENCY."""

    def __init__(self, folder):
        self.socket = str(folder / "sound")
        env = dict(os.environ, **{name: str(folder) for name in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME", "HOME")})
        self.server = subprocess.Popen(["pulseaudio", "-n", "--daemonize=no", "--exit-idle-time=-1", "--use-pid-file=no", "--log-level=error", f"--load={SINK}",
                                        f"--load=module-native-protocol-unix socket={self.socket} auth-anonymous=1"], env=env)
        appears(self.socket)
        self.listener = subprocess.Popen(["parec", f"--server=unix:{self.socket}", "--device=null.monitor", "--format=s16le", f"--rate={SAMPLES}", "--channels=1",
                                          "--raw", f"--latency-msec={LATENCY}"], stdout=subprocess.PIPE, bufsize=0)
        self.tones = []  # when they begin
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        heard, quiet_since = 0, 0
        begins = collections.deque(maxlen=200)  # of the stream, as by each piece of sound
        while piece := os.read(self.listener.stdout.fileno(), 1 << 16):
            begins.append(time.monotonic() - heard / SAMPLES)
            samples = struct.unpack(f"<{len(piece) // 2}h", piece[:len(piece) // 2 * 2])
            for i, sample in enumerate(samples):
                if abs(sample) > LOUD:
                    if heard + i - quiet_since > SAMPLES // 4:
                        self.tones.append(statistics.median(begins) + (heard + i) / SAMPLES)
                    quiet_since = heard + i
            heard += len(samples)

    def stop(self):
        for process in (self.listener, self.server):
            process.kill()
            process.wait()


class Stage:
    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-sound-"))
        self.folder.chmod(0o755)
        self.bus, self.screen, self.ear = Bus(self.folder), Screen(self.folder), Ear(self.folder)
        self.sound = self.ear.socket

    def stop(self):
        for part in (self.ear, self.screen, self.bus):
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


def main():
    stage = Stage()
    try:
        make_film(stage.folder / "film.mkv", int(3 * (SECONDS + SETTLING)) + 60)
        player = PLAYER(stage.folder / "film.mkv", stage)
        with contextlib.closing(contextlib.ExitStack()) as ways_out:
            ways_out.callback(player.kill)
            found = []
            for begins in (player.play, player.pause, lambda: player.seek(10.65)):
                begins()
                if begins == player.pause:
                    time.sleep(1)
                    player.play()
                begin = time.monotonic() + SETTLING
                time.sleep(SETTLING + SECONDS + 1)
                found.append(later(stage, begin, begin + SECONDS))
                assert len(found[-1]) > SECONDS / 2, f"{len(found[-1])} tones and pictures in {SECONDS} s, of {len(stage.ear.tones)} tones and {len(stage.screen.frames)} frames"
        print(f"| {player.kind} | " + " | ".join(f"{statistics.median(of):+.0f} ms" for of in found) + f" | {max(map(max, found)) - min(map(min, found)):.0f} ms |")
    finally:
        stage.stop()


main()
