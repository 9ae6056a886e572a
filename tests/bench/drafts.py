#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Drafts that visuotactile-follow makes while a real mpv plays a film without a track, without picture and sound: how long after each event what
plays is known, and so felt, and which share of a core it takes. Then how often it wakes the processor where nothing plays. Prints tables.

Expects FOLLOW, the plugins on GST_PLUGIN_PATH, ffmpeg, mpv, dbus-daemon and python3-dbus; takes two minutes.
Usage: drafts.py CLIP [SECONDS]      a film, ten seconds of which are scaled up to each size; how long each event is watched, 20 by default"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import dbus

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from mpv_socket import MpvSocket  # noqa: E402

FOLLOW, CLIP = os.environ["FOLLOW"], sys.argv[1]
WATCHED = float(sys.argv[2]) if len(sys.argv) > 2 else 20
SIZES = ((1920, 1080), (3840, 2160))
LATEST = 60
FILM = 600  # s
NAME, PATH = "org.visuotactile.Follow1", "/org/visuotactile/Follow1"
TICK = os.sysconf("SC_CLK_TCK")

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-drafts-"))
started = []


def start(*words, **options):
    process = subprocess.Popen(words, **options)
    started.append(process)
    return process


def wait_until(what, is_true):
    end = time.monotonic() + LATEST
    while not is_true():
        assert time.monotonic() < end, f"waited {LATEST} s in vain for {what}"
        time.sleep(0.005)


def make_film(width, height):
    """Ten seconds again and again, which begin with their only key frame: x264 puts none further apart by default."""
    once, film = work / f"{height}-once.mkv", work / f"{height}.mkv"
    subprocess.run(["ffmpeg", "-v", "error", "-nostdin", "-ss", "16", "-i", CLIP, "-vf", f"scale={width}:{height},fps=24", "-frames:v", "240", "-an", "-c:v", "libx264",
                    "-preset", "veryfast", "-crf", "20", "-g", "240", "-sc_threshold", "0", str(once)], check=True)
    subprocess.run(["ffmpeg", "-v", "error", "-nostdin", "-stream_loop", str(FILM // 10 - 1), "-i", str(once), "-c", "copy", str(film)], check=True)
    return film


class Mpv(MpvSocket):
    def __init__(self, film):
        super().__init__(str(work / "socket"))
        self.process = start("mpv", "--no-config", "--vo=null", "--ao=null", "--hwdec=no", f"--input-ipc-server={self.path}", str(film), "--pause", stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
        wait_until("mpv's socket", self.connects)

    def end(self):
        self.process.kill()
        self.process.wait()
        os.unlink(self.path)


def cpu(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def watch(pid, service, event, from_here):
    """Since a moment: when what plays was known first, with how much CPU time, when mpv played there, and the share of a core in each second."""
    begin, known, spent, plays, shares, before = time.monotonic(), None, 0, None, [], cpu(pid)
    first = before
    while time.monotonic() < begin + WATCHED:
        all_of_it = service.GetAll(NAME, dbus_interface="org.freedesktop.DBus.Properties")
        position, ahead = float(all_of_it["Position"]), float(all_of_it["Ahead"])
        if known is None and from_here <= position < from_here + WATCHED and all_of_it["Track"] and (ahead > 0.35 or ahead < 0):
            known, spent = time.monotonic() - begin, cpu(pid) - first
        if plays is None and from_here < position < from_here + WATCHED:
            plays = time.monotonic() - begin
        if time.monotonic() >= begin + len(shares) + 1:
            now = cpu(pid)
            shares.append(now - before)
            before = now
        time.sleep(0.02)
    mean = sum(shares) / len(shares)
    seconds = lambda value: "never" if value is None else f"{value:.1f} s"
    return f"| {event} | {seconds(plays)} | {seconds(known)} | {spent:.2f} s | {mean:.2f} | {max(shares):.2f} |"


def switches(pid):
    """How often its threads have waited."""
    return sum(int(line.split()[1]) for task in pathlib.Path(f"/proc/{pid}/task").iterdir() for line in open(task / "status", encoding="utf-8") if line.startswith("voluntary_"))


def wake_ups(bus, event, *words):
    """A second, from five seconds after the start on."""
    follower = start(FOLLOW, *words, "--driver=simulator", "--quiet", "--no-drafts")
    wait_until("the follower", lambda: bus.name_has_owner(NAME))
    time.sleep(5)
    before = switches(follower.pid)
    time.sleep(WATCHED)
    print(f"| {event} | {(switches(follower.pid) - before) / WATCHED:.1f} |", flush=True)
    follower.terminate()
    follower.wait()


def measure(width, height, bus):
    film = make_film(width, height)
    mpv = Mpv(film)
    follower = start(FOLLOW, f"--mpv={mpv.path}", "--driver=simulator", "--quiet")
    wait_until("the follower", lambda: bus.name_has_owner(NAME))
    service = bus.get_object(NAME, PATH)
    mpv.command("set_property", "pause", False)
    print(watch(follower.pid, service, f"{width}×{height}, it begins", 0), flush=True)
    # Just before a key frame: all since the one before has to be decoded.
    to = FILM // 2 + 9.5
    mpv.command("seek", to, "absolute", "exact")
    print(watch(follower.pid, service, f"{width}×{height}, a seek", to - 0.1), flush=True)
    follower.terminate()
    follower.wait()
    mpv.end()


try:
    print("| film, event | mpv plays there after | felt after | CPU until then | CPU, mean | most in a second |\n|---|---|---|---|---|---|", flush=True)
    line = start("dbus-daemon", "--session", "--nofork", "--print-address", stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    os.environ["DBUS_SESSION_BUS_ADDRESS"] = line.stdout.readline().strip()
    for name in ("XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        os.environ[name] = str(work / name)
    session = dbus.SessionBus(private=True)
    for size in SIZES:
        measure(*size, session)
    print("\nWaits of all threads, which each end with a wake-up:\n\n| nothing plays | wake-ups a second |\n|---|---|", flush=True)
    wake_ups(session, "no player is there")
    paused = Mpv(work / "1080.mkv")
    wake_ups(session, "mpv pauses", f"--mpv={paused.path}")
    paused.end()
finally:
    for process in started:
        process.kill()
        process.wait()
    shutil.rmtree(work)
