#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What visuotactile-follow does around a player, here a real mpv without picture and sound: where it finds tracks, drafts that it
makes, its status and its nudge, and its ways out: a locked screen, a computer that goes to sleep, a session bus that is gone.
logind is dbusmock's. Buses, settings and caches are the test's own.

Expects FOLLOW, TRACK, the plugins on GST_PLUGIN_PATH, mpv, dbus-daemon and python3-dbusmock.
Usage: follow_service.py [PART ...]      of drafts, embedded, library, status, ways_out; all by default"""

import csv
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

import dbus
import dbusmock

FOLLOW, TRACK = os.environ["FOLLOW"], os.environ["TRACK"]
LATEST = 60  # s: until something that has to happen has failed to
NAME, PATH = "org.visuotactile.Follow1", "/org/visuotactile/Follow1"
LOGIND = "org.freedesktop.login1"

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-follow-service-"))
started = []


def wait_until(what, is_true):
    end = time.monotonic() + LATEST
    while not is_true():
        assert time.monotonic() < end, f"waited {LATEST} s in vain for {what}"
        time.sleep(0.01)


def start(*words, **options):
    process = subprocess.Popen(words, **options)
    started.append(process)
    return process


def start_bus():
    """A bus of its own: the process and its address."""
    bus = start("dbus-daemon", "--session", "--nofork", "--print-address", stdout=subprocess.PIPE, text=True)
    return bus, bus.stdout.readline().strip()


class Mpv:
    def __init__(self, film, *options):
        self.path = str(work / "socket")
        pathlib.Path(self.path).unlink(missing_ok=True)
        self.process = start("mpv", "--no-config", "--vo=null", "--ao=null", f"--input-ipc-server={self.path}", *options, str(film),
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.line = socket.socket(socket.AF_UNIX)
        wait_until("mpv's socket", self._connects)

    def _connects(self):
        try:
            self.line.connect(self.path)
        except OSError:
            return False
        return True

    def command(self, *words):
        self.line.sendall((json.dumps({"command": words}) + "\n").encode())

    def quit(self):
        self.command("quit")
        self.process.wait(LATEST)


class Follower:
    def __init__(self, mpv, *options):
        self.log, self.trace = work / "log", work / "trace.csv"
        self.trace.unlink(missing_ok=True)
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = start(FOLLOW, f"--mpv={mpv.path}", "--driver=simulator", f"--trace={self.trace}", *options, stderr=log)

    def said(self):
        return self.log.read_text(encoding="utf-8")

    def wait_for(self, text):
        wait_until(f"'{text}' in: {self.said()}", lambda: text in self.said() or self.process.poll() is not None)
        assert text in self.said(), self.said()

    def commands(self):
        """Those in the trace: (issued, volts) in seconds; the last line may be written still."""
        if not self.trace.exists():
            return []
        lines = self.trace.read_text(encoding="utf-8").split("\n")
        return [(int(row["issued_ns"]) / 1e9, float(row["volts"])) for row in csv.DictReader(lines[:-1])]

    def is_felt(self, after=0.0):
        return any(volts > 0 for issued, volts in self.commands() if issued > after)

    def wait_to_feel(self):
        after = time.monotonic()
        wait_until("something that is felt", lambda: self.is_felt(after))

    def levels(self):
        """The last command of each motor."""
        lines = self.trace.read_text(encoding="utf-8").split("\n")
        return {row["tactor"]: float(row["volts"]) for row in csv.DictReader(lines[:-1])}

    def is_silent(self):
        return not any(self.levels().values())

    def end(self, status=0):
        if status == 0:
            self.process.send_signal(signal.SIGINT)
        assert self.process.wait(LATEST) == status, self.said()
        assert self.is_silent(), self.levels()


def make_film(name, seconds, pattern="dynamic-motion", muxer="matroskamux"):
    film = work / "films" / name
    film.parent.mkdir(exist_ok=True)
    picture = f"tactiletestsrc num-buffers={seconds * 25} pattern={pattern}" if pattern else f"videotestsrc num-buffers={seconds * 25} pattern=black"
    subprocess.run(["gst-launch-1.0", "-q", *picture.split(), "!", "video/x-raw,width=320,height=240,framerate=25/1", "!", "x264enc", "speed-preset=ultrafast",
                    "key-int-max=50", "!", muxer, "!", "filesink", f"location={film}"], check=True)
    return film


def make_track(path, seconds):
    """A pulse of 700 ms in each second but the first."""
    rows = ["# tactile grid=1x1 rate=5", "time_ms,t0"]
    for second in range(1, seconds):
        rows += [f"{second * 1000},1", f"{second * 1000 + 700},0"]
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(rows + [f"{seconds * 1000},0"]) + "\n", encoding="utf-8")


def track(*words):
    return subprocess.run([TRACK, *words], capture_output=True, text=True, check=False, timeout=LATEST)


def drafts():
    """From the middle on, then the rest; the same draft as tactile-track author makes at once."""
    film = make_film("drafted.mkv", 30)
    mpv = Mpv(film, "--start=20", "--loop")
    follower = Follower(mpv)
    follower.wait_for("plays 'drafted.mkv' with a draft that is made while it plays")
    follower.wait_to_feel()
    follower.wait_for("is complete, and kept for the next time")
    mpv.command("seek", 3, "absolute")
    follower.wait_to_feel()
    follower.end()
    assert [file.name for file in film.parent.iterdir()] == ["drafted.mkv"], "something was written beside the film"
    kept = list((work / "cache/visuotactile/drafts").iterdir())
    assert len(kept) == 1, kept
    at_once = work / "at-once.vtt"
    assert track("author", "-q", str(film), "-o", str(at_once)).returncode == 0
    info = [track("info", str(file)).stdout.split("\n")[1:] for file in (at_once, kept[0])]
    print("at once:", *info[0], "while it played:", *info[1], sep="\n")
    same_films(at_once, kept[0])
    # The next time, and under another name.
    other = film.with_name("renamed.mkv")
    film.rename(other)
    mpv.command("loadfile", str(other))
    follower = Follower(mpv)
    follower.wait_for("plays 'renamed.mkv' with a draft of an earlier time")
    follower.wait_to_feel()
    follower.end()
    mpv.quit()
    other.unlink()


def cues(path):
    """(begin, end, percents) of a track's cues that are felt, in ms."""
    found = []
    for block in path.read_text(encoding="utf-8").split("\n\n"):
        lines = block.strip().split("\n")
        if " --> " in lines[0]:
            begin, end = (sum(float(part) * scale for part, scale in zip(time.split(":"), (3600e3, 60e3, 1e3))) for time in lines[0].split(" --> "))
            found.append((begin, end, [int(word) for line in lines[1:] for word in line.split()]))
    return found


def level_at(found, at):
    return next((levels for begin, end, levels in found if begin <= at < end), [0] * 9)


def same_films(expected, got):
    """The analysis adapts to what it saw before, so that a draft from the middle on differs a little for a while."""
    one, other = cues(expected), cues(got)
    assert one[-1][1] == other[-1][1] or abs(one[-1][1] - other[-1][1]) < 1000, (one[-1], other[-1])
    off = [abs(a - b) for at in range(0, 30000, 100) for a, b in zip(level_at(one, at), level_at(other, at))]
    mean = sum(off) / len(off)
    print(f"levels differ by {mean:.1f} % on average")
    felt = sum(sum(level_at(one, at)) for at in range(0, 30000, 100)) / len(off)
    assert mean < felt / 3, (mean, felt)


PARTS = {"drafts": drafts}

try:
    session, os.environ["DBUS_SESSION_BUS_ADDRESS"] = start_bus()
    _, os.environ["DBUS_SYSTEM_BUS_ADDRESS"] = start_bus()
    os.environ["XDG_CACHE_HOME"], os.environ["XDG_CONFIG_HOME"] = str(work / "cache"), str(work / "config")
    for part in sys.argv[1:] or PARTS:
        begin = time.monotonic()
        PARTS[part]()
        print(f"{part}: {time.monotonic() - begin:.1f} s", flush=True)
finally:
    for process in started:
        process.kill()
        process.wait()
    shutil.rmtree(work)
