#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""visuotactile-follow and a real mpv in Xvfb, without sound: commands in the trace against the times at which frames come to the screen, through a seek, a pause, another rate and a crash; what is said without a track, and wrong command lines.

Prints a table. Expects FOLLOW, the plugins on GST_PLUGIN_PATH, mpv, ffmpeg and Xvfb.
Usage: follow.py [SECONDS]      how long each stretch is watched, 5 by default"""

import csv
import ctypes
import json
import os
import pathlib
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time

FOLLOW = os.environ["FOLLOW"]
LATEST = 60  # s: until something that has to happen has failed to
STRETCH = float(sys.argv[1]) if len(sys.argv) > 1 else 5
FILM = 40 + int(8 * STRETCH)  # s
FRAME = 1 / 24
BITS, BAR, HEIGHT = 14, 16, 64  # of a frame's number, as bars of pixels

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-follow-"))
started = []


def wait_until(what, is_true):
    end = time.monotonic() + LATEST
    while not is_true():
        assert time.monotonic() < end, f"waited {LATEST} s in vain for {what}"
        time.sleep(0.005)


class Screen:
    """Xvfb's, and when which frame came to it: (time, position), looked at all the time."""

    def __init__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "320x240x24"], pass_fds=[write], stderr=subprocess.DEVNULL)
        started.append(self.server)
        os.close(write)
        with os.fdopen(read, encoding="ascii") as line:
            self.name = ":" + line.readline().strip()
        self.frames, self.ended = [], False
        self.thread = threading.Thread(target=self._watch, daemon=True)
        self.thread.start()

    def stop(self):
        self.ended = True
        self.thread.join()

    def _watch(self):
        x11 = ctypes.CDLL("libX11.so.6")
        x11.XOpenDisplay.restype = x11.XGetImage.restype = ctypes.c_void_p
        x11.XDefaultRootWindow.argtypes = [ctypes.c_void_p]
        x11.XDefaultRootWindow.restype = ctypes.c_ulong
        x11.XGetImage.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_int, ctypes.c_uint, ctypes.c_uint, ctypes.c_ulong, ctypes.c_int]
        x11.XGetPixel.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int]
        x11.XGetPixel.restype = ctypes.c_ulong
        x11.XDestroyImage.argtypes = [ctypes.c_void_p]
        display = x11.XOpenDisplay(self.name.encode())
        root, before = x11.XDefaultRootWindow(display), None
        while not self.ended:
            image = x11.XGetImage(display, root, 0, HEIGHT // 2, BITS * BAR, 1, 0xFFFFFF, 2)
            now = time.monotonic()
            number = sum(1 << bit for bit in range(BITS) if x11.XGetPixel(image, bit * BAR + BAR // 2, 0) & 0x80)
            x11.XDestroyImage(image)
            if number != before:
                self.frames.append((now, number / 24))
            before = number
            time.sleep(0.001)


class Mpv:
    """A player, and when it told which frame: (time, position) on CLOCK_MONOTONIC."""

    def __init__(self, film, screen):
        self.path = str(work / "socket")
        self.process = subprocess.Popen(["mpv", "--no-config", "--vo=x11", "--ao=null", "--no-border", "--geometry=+0+0", "--pause", "--no-osc",
                                         f"--input-ipc-server={self.path}", film], env=dict(os.environ, DISPLAY=screen.name),
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        started.append(self.process)
        self.line = socket.socket(socket.AF_UNIX)
        wait_until("mpv's socket", self._connects)
        self.frames = []
        threading.Thread(target=self._listen, daemon=True).start()
        self.command("observe_property", 1, "time-pos")

    def _connects(self):
        try:
            self.line.connect(self.path)
        except OSError:
            return False
        return True

    def command(self, *words):
        self.line.sendall((json.dumps({"command": words}) + "\n").encode())
        return time.monotonic()

    def _listen(self):
        try:
            for line in self.line.makefile():
                now, told = time.monotonic(), json.loads(line)
                if told.get("name") == "time-pos" and told.get("data") is not None:
                    self.frames.append((now, told["data"]))
        except OSError:
            pass  # it was killed


def trace():
    """(issued, effect, volts) in seconds; the last line may be written still."""
    with open(work / "trace.csv", encoding="utf-8") as file:
        lines = file.read().split("\n")
    return [(int(row["issued_ns"]) / 1e9, int(row["effect_ns"]) / 1e9, float(row["volts"])) for row in csv.DictReader(lines[:-1])]


def onsets(rows):
    """When a pulse is felt in full."""
    found, on = [], False
    for _, effect, volts in rows:
        if volts > 2.9 and not on:
            found.append(effect)
        on = volts > 0 and (on or volts > 2.9)
    return found


def position(frames, at):
    """The film's position by the frames within half a second."""
    near = [p + rate * (at - t) for t, p, rate in frames if abs(at - t) < 0.5]
    return statistics.median(near) if len(near) >= 8 else None


def follow(*words, **options):
    return subprocess.run([FOLLOW, *words], capture_output=True, text=True, timeout=LATEST, check=False, **options)


def refuses():
    for words, said in ((["--driver=sofa"], "--driver is one of auto"), (["--intensity=2"], "--intensity is a number from 0 to 1"),
                        (["--offset=9000"], "--offset is a number of ms"), (["film.mkv"], "expected"), (["--mpv"], "Missing argument")):
        result = follow(*words)
        assert result.returncode == 2 and said in result.stderr, (words, result)
    alone = dict(os.environ, DBUS_SESSION_BUS_ADDRESS="unix:path=/nowhere", XDG_RUNTIME_DIR=str(work))
    result = follow("--mpris=vlc", env=alone)
    assert result.returncode == 1 and "cannot reach the session bus" in result.stderr, result
    result = follow("--list-players", env=alone)
    assert result.returncode == 0 and result.stdout == "No player is there.\n", result


def make_film(name):
    """Each frame shows its number in bars, the lowest bit first."""
    bars = f"geq=lum='235*mod(floor(N/pow(2,floor(X/{BAR}))),2)':cb=128:cr=128"
    subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", f"color=black:s={BITS * BAR}x{HEIGHT}:r=24:d={FILM},format=yuv420p,{bars}",
                    "-c:v", "libx264", "-preset", "ultrafast", "-qp", "8", "-g", "24", str(work / name)], check=True)


def make_track(name):
    """A pulse of 700 ms from each even second on; more would be cut by max-duty."""
    rows = ["# tactile grid=1x1 rate=5", "time_ms,t0"]
    for second in range(2, FILM, 2):
        rows += [f"{second * 1000},1", f"{second * 1000 + 700},0"]
    (work / name).write_text("\n".join(rows + [f"{FILM * 1000},0"]) + "\n", encoding="utf-8")


def plays(screen):
    make_track("film.csv")
    mpv = Mpv(str(work / "film.mkv"), screen)
    log = open(work / "log", "w", encoding="utf-8")
    follower = subprocess.Popen([FOLLOW, f"--mpv={mpv.path}", "--driver=simulator", f"--trace={work / 'trace.csv'}"], stderr=log)
    started.append(follower)
    said = lambda: (work / "log").read_text(encoding="utf-8")
    wait_until("the track", lambda: f"plays 'film.mkv' with '{work}/film.csv'" in said())
    wait_until("the trace", (work / "trace.csv").exists)
    wait_until("a list of players", lambda: "paused 'film.mkv' at 0.0 s" in follow("--list-players", f"--mpv={mpv.path}").stdout)

    stretches, events = [], []

    def watch(name):
        """From 1 s from now on."""
        begin = time.monotonic() + 1
        wait_until(f"frames, {name}", lambda: mpv.frames[-1][0] > begin + STRETCH)
        stretches.append((name, begin, begin + STRETCH))

    def wait_for_pulse():
        """Until a pulse has begun that lasts half a second more."""
        wait_until("a pulse", lambda: 0.15 < mpv.frames[-1][1] % 2 < 0.25 and mpv.frames[-1][0] > time.monotonic() - 0.05)

    def happens(name, at):
        """Is looked at as long as the pulse would have lasted."""
        events.append((name, at))
        time.sleep(0.5)

    mpv.command("set_property", "pause", False)
    watch("playing")
    listed = follow("--list-players", f"--mpv={mpv.path}", "--driver=simulator", f"--trace={work / 'listed.csv'}").stdout
    assert "plays 'film.mkv'" in listed and not (work / "listed.csv").exists(), listed
    wait_for_pulse()
    happens("pause", mpv.command("set_property", "pause", True))
    mpv.command("set_property", "pause", False)
    watch("after a pause")
    mpv.command("seek", 10.65, "relative", "exact")
    watch("after a seek")
    mpv.command("set_property", "speed", 1.25)
    watch("at rate 1.25")
    mpv.command("set_property", "speed", 1)
    watch("at rate 1 again")
    wait_for_pulse()
    os.kill(mpv.process.pid, signal.SIGSTOP)
    happens("player hangs", time.monotonic())
    os.kill(mpv.process.pid, signal.SIGCONT)
    watch("after a hang")
    wait_for_pulse()
    mpv.process.kill()
    happens("player killed", time.monotonic())
    wait_until("the end of mpv", lambda: "is gone: it has closed its socket" in said())
    follower.terminate()
    assert follower.wait(LATEST) == 0, said()
    rows = trace()
    assert rows[-1][2] == 0

    print("| mpv | pulses | p50 | most |\n|---|---|---|---|")
    for name, begin, end in stretches:
        rate = 1.25 if "1.25" in name else 1
        frames = [(at, where, rate) for at, where in screen.frames if begin - 0.5 < at < end]
        errors = []
        for effect in onsets(rows):
            at = position(frames, effect) if begin < effect < end - 0.5 else None
            if at is not None:
                errors.append(1000 * (at - 2 * round(at / 2)) / rate)
        assert errors, f"nothing felt {name}"
        middle = statistics.median(errors)
        print(f"| {name} | {len(errors)} | {middle:+.1f} ms | {max(errors, key=abs):+.1f} ms |")
        assert abs(middle) < 1000 * FRAME / 2, f"{name}: not in time by half a frame"
    print("\n| event | until the motor is at zero |\n|---|---|")
    for name, at in events:
        assert [volts for issued, _, volts in rows if issued < at][-1] > 2.9, f"{name}: nothing was felt"
        zeros = [issued for issued, _, volts in rows if at <= issued < at + 0.5 and volts == 0]
        assert zeros, f"{name}: the motor is on for half a second"
        print(f"| {name} | {1000 * (zeros[0] - at):.0f} ms |")


def has_no_track(screen):
    mpv = Mpv(str(work / "other.mkv"), screen)
    (work / "other.vtt").write_text("WEBVTT\n\n00:01.000 --> 00:02.000\nHello!\n", encoding="utf-8")
    with open(work / "log", "w", encoding="utf-8") as log:
        follower = subprocess.Popen([FOLLOW, f"--mpv={mpv.path}", "--driver=simulator", f"--tracks={work / 'tracks'}", "--no-drafts"], stderr=log)
    started.append(follower)
    said = lambda: (work / "log").read_text(encoding="utf-8")
    # Subtitles are no track.
    wait_until("a complaint", lambda: "no track for 'other.mkv': expected a track, got" in said())
    assert f"{work}/other.vtt" in said() and "tactile-track author" in said(), said()
    # The next film has one, in the folder.
    (work / "tracks").mkdir()
    make_track("tracks/film.csv")
    (work / "film.csv").unlink()
    mpv.command("loadfile", str(work / "film.mkv"))
    wait_until("the next film", lambda: f"plays 'film.mkv' with '{work}/tracks/film.csv'" in said())
    mpv.command("quit")
    wait_until("the end of mpv", lambda: "is gone" in said())
    follower.send_signal(signal.SIGINT)
    assert follower.wait(LATEST) == 0, said()


try:
    refuses()
    make_film("film.mkv")
    shutil.copy(work / "film.mkv", work / "other.mkv")
    screen = Screen()
    try:
        plays(screen)
    finally:
        screen.stop()
    has_no_track(screen)
finally:
    for process in started:
        process.kill()
        process.wait()
    shutil.rmtree(work)
