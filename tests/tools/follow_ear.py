#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""By ear: mpv plays a film in Xvfb, its sound goes through a synthetic room in PulseAudio, with noise, and visuotactile-follow listens to it. Commands in the
trace against the times at which frames come to the screen; beside it a second one, which follows mpv's report.

Prints lines of a table. Expects FOLLOW, TRACK, the plugins on GST_PLUGIN_PATH, mpv, ffmpeg, Xvfb, pulseaudio and dbus-daemon.
Usage: follow_ear.py [SECONDS]      SECONDS: how long each stretch is watched (default: 30)"""

import contextlib
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from film_sound import make_room, make_sound
from follow_players import LATEST, Bus, Mpv, wait_until
from follow_screen import Screen, make_film
from follow_trace import make_track, onsets, read_trace
from null_sink import RATE, NullSink

FOLLOW, TRACK = os.environ["FOLLOW"], os.environ["TRACK"]
STRETCH = int(sys.argv[1]) if len(sys.argv) > 1 else 30
SETTLING = 5  # s, after it was found
SEEK = 20  # s
FINDING = 12  # s, at most
FILM = 2 * (STRETCH + SETTLING + FINDING + 3) + SEEK
NOISE = {"silence": None, "pink noise, +10 dB": 10, "pink noise, 0 dB": 0}


def level_of(wav):
    """In dB of full scale."""
    said = subprocess.run(["ffmpeg", "-nostdin", "-i", str(wav), "-af", "volumedetect", "-f", "null", "-"], capture_output=True, text=True, check=True).stderr
    return float(said.split("mean_volume: ")[1].split()[0])


def run_ffmpeg(*words):
    subprocess.run(["ffmpeg", "-v", "error", *map(str, words)], check=True)


class Stage:
    def __init__(self, folder, decay):
        self.folder = folder
        self.bus, self.screen = Bus(folder), Screen(folder)
        # mpv's sink makes the room of what goes on to the null sink, whose monitor is the microphone.
        room = make_room(folder / "room.wav", decay, RATE)
        self.sound = NullSink(folder, f"module-virtual-surround-sink sink_name=room sink_master=null hrir={room}")
        self.env = dict(os.environ, DBUS_SESSION_BUS_ADDRESS=self.bus.address, HOME=str(folder), XDG_CONFIG_HOME=str(folder / "config"),
                        XDG_CACHE_HOME=str(folder / "cache"), XDG_RUNTIME_DIR=str(folder), PULSE_SERVER=f"unix:{self.sound.socket}")
        os.environ["PULSE_SINK"] = "room"  # of players
        self.started = []

    def start(self, *words, **options):
        self.started.append(subprocess.Popen([str(word) for word in words], env=self.env, **options))
        return self.started[-1]

    def stop(self):
        for process in self.started:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            process.wait()
        for part in (self.sound, self.screen, self.bus):
            part.stop()

    def follow(self, name, *words):
        with open(self.folder / f"{name}.log", "w", encoding="utf-8") as log:
            return self.start(FOLLOW, "--driver=simulator", f"--trace={self.folder / name}.csv", f"--tracks={self.folder / 'tracks'}", "--no-drafts", *words, stderr=log)

    def said(self, name):
        return (self.folder / f"{name}.log").read_text(encoding="utf-8")

    def errors(self, name, begin, end):
        """How much later than its frame a pulse is felt in full, in ms."""
        found = []
        for effect in onsets(read_trace(self.folder / f"{name}.csv")):
            frames = self.screen.known(effect - 0.5, effect + 0.5)
            if begin < effect < end and len(frames) >= 8:
                position = statistics.median(at + effect - shown for shown, at in frames)
                found.append(1000 * (position - round(position)))
        return found


def row(noise, event, found):
    print(f"| {noise} | {event} | {found[0]:.1f} s | " + " | ".join(
        f"{len(errors)} | {statistics.median(errors):+.1f} ms | {sorted(map(abs, errors))[max(0, len(errors) * 95 // 100 - 1)]:.1f} ms" for errors in found[1:])
        + " |", flush=True)


def watch(noise, level):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-ear-"))
    folder.chmod(0o755)
    (folder / "tracks").mkdir()
    sound = make_sound(folder / "film.wav", 5, FILM)
    (folder / "learned").mkdir()
    make_film(folder / "learned/film.mkv", FILM, sound)
    if level is not None:
        pink, mixed = folder / "pink.wav", folder / "mixed.wav"
        run_ffmpeg("-f", "lavfi", "-i", f"anoisesrc=color=pink:r=16000:a=0.3:d={FILM}", pink)
        run_ffmpeg("-i", sound, "-i", pink, "-filter_complex", f"[1]volume={level_of(sound) - level - level_of(pink)}dB[n];[0][n]amix=normalize=0,volume=-6dB", mixed)
        sound = mixed
    make_film(folder / "film.mkv", FILM, sound)
    make_track(folder / "tracks/film.csv", [(second, 0.35) for second in range(1, FILM - 2)], FILM)
    subprocess.run([TRACK, "learn", "--quiet", str(folder / "learned/film.mkv"), str(folder / "tracks/film.csv")], check=True)
    stage = Stage(folder, 0.4)
    try:
        player = Mpv(folder / "film.mkv", stage)
        followers = [stage.follow("ear", "--listen=null.monitor", "--mpv=/nowhere"), stage.follow("report", *player.how)]
        wait_until("the listener", lambda: "listens to 'null.monitor'" in stage.said("ear"))
        events = []
        for event, act in (("start", player.play), ("seek", lambda: player.seek(SEEK))):
            at = act()
            events.append((event, at))
            wait_until("the stretch", lambda: time.monotonic() > at + FINDING + SETTLING + STRETCH, FINDING + SETTLING + STRETCH + LATEST)
        for follower in followers:  # the traces are whole
            follower.terminate()
            assert follower.wait(LATEST) == 0, stage.said("ear")
        for event, at in events:
            # Pulses on their way when the film seeks are not of its new place.
            first = next(effect for effect in onsets(read_trace(folder / "ear.csv")) if effect > at + (0 if event == "start" else 2.5))
            begin = first + SETTLING
            row(noise, event, [first - at, *(stage.errors(name, begin, begin + STRETCH) for name in ("ear", "report"))])
    finally:
        stage.stop()
        shutil.rmtree(folder)


for noise_name, decibels in NOISE.items():
    watch(noise_name, decibels)
