#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""visuotactile-follow and a real player in Xvfb: commands in the trace against the times at which frames come to the screen, through a pause, a seek, another rate, and how soon the motor is at zero when the player pauses, hangs or is killed. With mpv also what is said without a track, and wrong command lines.

Prints a table. Expects FOLLOW, the plugins on GST_PLUGIN_PATH, the players, ffmpeg, Xvfb and dbus-daemon.
Usage: follow.py PLAYER [SECONDS]      PLAYER: mpv, vlc, kodi, chromium or chromium-extended; SECONDS: how long each stretch is watched from 3 s after its event on (default: 4, from 1.5 s on)"""

import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

from follow_players import LATEST, PLAYERS, Bus, Chromium, Kodi, Mpv, Vlc, wait_until
from follow_screen import RATE, Screen, make_film
from null_sink import NullSink
from follow_trace import make_track, onsets, read_trace

FOLLOW = os.environ["FOLLOW"]
PLAYER = PLAYERS[sys.argv[1]]
STRETCH, SETTLING = (float(sys.argv[2]), 3) if len(sys.argv) > 2 else (4, 1.5)
FASTER = 2 if PLAYER is Kodi else 1.25  # Kodi 20's JSON-RPC knows whole rates only
SEEK = 10.65  # s
# From then on the film's pulses are long, to be ended.
LONG = int((3 + FASTER) * (STRETCH + SETTLING) + SEEK + 20)
LONG_EVERY = 4
FILM = LONG + 40
# s, of the median: a busy computer shows frames late, what VLC and Kodi tell is up to 0.29 s old, and what Chromium tells is itself off by up to 0.1 s
MOST = 0.5 / RATE if PLAYER is Mpv else 0.16 if PLAYER is Chromium else 0.06


class Stage:
    """What the players need."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-follow-"))
        self.folder.chmod(0o755)
        self.bus, self.screen = Bus(self.folder), Screen(self.folder)
        self.sound = NullSink(self.folder)
        self.started = []
        self.env = dict(os.environ, DBUS_SESSION_BUS_ADDRESS=self.bus.address, HOME=str(self.folder), XDG_CONFIG_HOME=str(self.folder / "config"),
                        XDG_CACHE_HOME=str(self.folder / "cache"), XDG_RUNTIME_DIR=str(self.folder))

    def stop(self):
        for process in self.started:
            process.kill()
        self.sound.stop()
        self.screen.stop()
        self.bus.stop()
        shutil.rmtree(self.folder)

    def play(self, player, film):
        self.started.append(player(self.folder / film, self))
        return self.started[-1]

    def follow(self, *words):
        """In the background. Returns the process, and a function of what it said."""
        with open(self.folder / "log", "w", encoding="utf-8") as log:
            process = subprocess.Popen([FOLLOW, *words], stderr=log, env=self.env)
        self.started.append(process)
        return process, lambda: (self.folder / "log").read_text(encoding="utf-8")

    def run(self, *words, **environment):
        return subprocess.run([FOLLOW, *words], capture_output=True, text=True, timeout=LATEST, check=False, env=dict(self.env, **environment))

    def make_track(self, name):
        """A pulse of 350 ms from each second on, then long ones; more would be cut by max-duty."""
        make_track(self.folder / name, [(second, 0.35) for second in range(1, LONG - 2)] + [(second, 1.4) for second in range(LONG, FILM - 2, LONG_EVERY)], FILM)


def refuses(stage):
    for words, said in ((["--driver=sofa"], "--driver is one of auto"), (["--intensity=2"], "--intensity is a number from 0 to 1"),
                        (["--screen-latency=9000"], "--screen-latency is a number from -5000 to 5000, got 9000"),
                        (["--sound-latency=nan"], "--sound-latency is a number from -5000 to 5000, got nan"), (["--sync-to=smell"], "--sync-to is one of screen, sound, got 'smell'"), (["film.mkv"], "expected"), (["--mpv"], "Missing argument")):
        result = stage.run(*words)
        assert result.returncode == 2 and said in result.stderr, (words, result)
    alone = {"DBUS_SESSION_BUS_ADDRESS": "unix:path=/nowhere"}
    result = stage.run("--mpris=vlc", **alone)
    assert result.returncode == 1 and "cannot reach the session bus" in result.stderr, result
    result = stage.run("--list-players", **alone)
    assert result.returncode == 0 and result.stdout == "No player is there.\n", result


class Watch:
    """A player that is followed, and what comes of it."""

    def __init__(self, stage):
        self.stage, self.screen = stage, stage.screen
        self.player = stage.play(PLAYER, PLAYER.file)
        self.follower, self.said = stage.follow(*self.player.how, "--driver=simulator", f"--trace={stage.folder / 'trace.csv'}")
        self.stretches, self.events = [], []

    def stretch(self, name, rate=1):
        begin = time.monotonic() + SETTLING
        wait_until(f"frames, {name}", lambda: time.monotonic() > begin + STRETCH + 1 and self.screen.now() is not None, STRETCH + LATEST)
        self.stretches.append((name, rate, begin, begin + STRETCH))

    def long_pulse(self):
        """Until a new one has begun that lasts 0.95 s more."""

        def since():
            position = self.screen.now()
            return (position - LONG) % LONG_EVERY if position is not None and position > LONG - 2 else None

        wait_until("no long pulse", lambda: (since() or 0) > LONG_EVERY / 2)
        wait_until("a long pulse", lambda: 0.3 < (since() or 0) < 0.45)

    def happens(self, name, at):
        """Is looked at for longer than anything takes, and for less than the pulse would have lasted."""
        self.events.append((name, at))
        time.sleep(0.9)


def errors_of(screen, rows, rate, begin, end):
    """How much later than its frame a pulse is felt in full, in ms."""
    found = []
    for effect in onsets(rows):
        frames = screen.known(effect - 0.5, effect + 0.5)
        if begin < effect < end and len(frames) >= 8:
            position = statistics.median(at + rate * (effect - time) for time, at in frames)
            found.append(1000 * (position - round(position)) / rate)
    return found


def quantile(values, share):
    values = sorted(values)
    return values[round(share * (len(values) - 1))]


def lists(stage, player):
    """By any way, each player is there once."""
    listed = stage.run("--list-players", *([] if PLAYER is Vlc else player.how), "--driver=simulator", f"--trace={stage.folder / 'listed.csv'}").stdout
    assert not (stage.folder / "listed.csv").exists()
    return listed


def plays(stage):
    stage.make_track("film.csv")
    watch = Watch(stage)
    player, said = watch.player, watch.said
    wait_until("a list of players", lambda: f"{player.name}: paused '{player.film}'" in lists(stage, player))
    player.play()
    wait_until("the track", lambda: f"{player.name} plays '{player.film}' with '{stage.folder}/film.csv'" in said())
    wait_until("the trace", (stage.folder / "trace.csv").exists)
    watch.stretch("after the start")
    listed = lists(stage, player)
    assert listed.count("\n") == 1 and f"{player.name}: plays '{player.film}' at " in listed, listed
    player.pause()
    time.sleep(0.5)
    player.play()
    watch.stretch("after a pause")
    player.seek(SEEK)
    watch.stretch("after a seek")
    player.rate(FASTER)
    watch.stretch(f"at rate {FASTER}", FASTER)
    player.rate(1)
    time.sleep(1)
    wait_until("frames at rate 1", lambda: watch.screen.now() is not None)
    player.seek(LONG - 1 - watch.screen.now())
    watch.long_pulse()
    watch.happens("pause", player.pause())
    player.play()
    watch.long_pulse()
    watch.happens("player hangs", player.hang())
    player.go_on()
    watch.long_pulse()
    watch.happens("player killed", player.kill())
    wait_until("the end of the player", lambda: f"{player.name} is gone: " in said())
    watch.follower.terminate()
    assert watch.follower.wait(LATEST) == 0, said()

    rows = read_trace(stage.folder / "trace.csv")
    assert rows[-1][2] == 0
    print(f"| {sys.argv[1]} | pulses | p50 | p95 |\n|---|---|---|---|")
    found = []
    for name, rate, begin, end in watch.stretches:
        errors = errors_of(watch.screen, rows, rate, begin, end)
        assert errors, f"nothing felt {name}"
        middle = statistics.median(errors)
        print(f"| {name} | {len(errors)} | {middle:+.1f} ms | {quantile([abs(error) for error in errors], 0.95):.1f} ms |", flush=True)
        assert abs(middle) < 1000 * MOST, f"{name}: off by {middle} ms"
        found += errors
    assert abs(statistics.median(found)) < 80, f"off by {statistics.median(found)} ms"
    print("\n| event | until the motor is at zero |\n|---|---|")
    for name, at in watch.events:
        assert [volts for issued, _, volts in rows if issued < at][-1] > 2.9, f"{name}: nothing was felt"
        zeros = [issued for issued, _, volts in rows if at <= issued < at + 0.9 and volts == 0]
        assert zeros, f"{name}: the motor stays on"
        print(f"| {name} | {1000 * (zeros[0] - at):.0f} ms |")


def has_no_track(stage):
    (stage.folder / "film.csv").rename(stage.folder / "film.away")
    shutil.copy(stage.folder / "film.mkv", stage.folder / "other.mkv")
    (stage.folder / "other.vtt").write_text("WEBVTT\n\n00:01.000 --> 00:02.000\nHello!\n", encoding="utf-8")
    mpv = stage.play(Mpv, "other.mkv")
    follower, said = stage.follow(*mpv.how, "--driver=simulator", f"--tracks={stage.folder / 'tracks'}", "--no-drafts")
    # Subtitles are no track.
    wait_until("a complaint", lambda: "no track for 'other.mkv': expected a track, got" in said())
    assert f"{stage.folder}/other.vtt" in said() and "tactile-track author" in said(), said()
    # The next film has one, in the folder.
    (stage.folder / "tracks").mkdir()
    stage.make_track("tracks/film.csv")
    mpv.load(stage.folder / "film.mkv")
    wait_until("the next film", lambda: f"plays 'film.mkv' with '{stage.folder}/tracks/film.csv'" in said())
    follower.send_signal(signal.SIGINT)
    assert follower.wait(LATEST) == 0, said()
    is_in_sync_with_the_sound(stage, mpv)
    mpv.kill()


def is_in_sync_with_the_sound(stage, mpv):
    """Which is 200 ms later than the picture."""
    settings, trace = stage.folder / "config/visuotactile/follow.conf", stage.folder / "later.csv"
    settings.parent.mkdir(parents=True, exist_ok=True)
    settings.write_text("[mpv]\nsound-latency=200\nscreen-latency=-350\n", encoding="utf-8")
    mpv.play()
    follower, said = stage.follow(*mpv.how, "--driver=simulator", f"--trace={trace}", f"--tracks={stage.folder / 'tracks'}", "--sync-to=sound")
    begin = time.monotonic() + SETTLING
    found = lambda: errors_of(stage.screen, read_trace(trace), 1, begin, time.monotonic() - 0.5)
    wait_until("three pulses", lambda: trace.exists() and len(found()) >= 3)
    follower.terminate()
    assert follower.wait(LATEST) == 0, said()
    late = statistics.median(found())
    assert abs(late - 200) < 1000 * MOST, f"felt {late} ms later than the picture"


stage = Stage()
try:
    if PLAYER is Mpv:
        refuses(stage)
    make_film(stage.folder / "film.mkv", FILM)
    if PLAYER.file == "film.ts":
        subprocess.run(["ffmpeg", "-v", "error", "-i", stage.folder / "film.mkv", "-c:v", "copy", "-c:a", "mp2", stage.folder / PLAYER.file], check=True)
        (stage.folder / PLAYER.file).chmod(0o644)
    plays(stage)
    if PLAYER is Mpv and SETTLING < 3:
        has_no_track(stage)
finally:
    stage.stop()
