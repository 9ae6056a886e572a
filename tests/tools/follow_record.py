#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Records what a real player in Xvfb reports while it plays, pauses, seeks and plays faster, with the frames on its screen, for the test `recorded_reports`.

Usage: follow_record.py PLAYER FILE [SECONDS]      PLAYER: mpv, vlc, kodi, chromium or chromium-extended; SECONDS: of each stretch (default: 12)
Expects RECORD, the program followrecord."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from follow_players import PLAYERS, Bus, Kodi
from follow_screen import KNOWN_TO, Screen, make_film
from null_sink import NullSink

PLAYER = PLAYERS[sys.argv[1]]
SECONDS = float(sys.argv[3]) if len(sys.argv) > 3 else 12


class Stage:
    def __init__(self, folder):
        self.folder, self.bus, self.screen = folder, Bus(folder), Screen(folder)
        self.sound = NullSink(folder)


folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-record-"))
folder.chmod(0o755)
stage = Stage(folder)
try:
    make_film(folder / "film.mkv", int(6 * SECONDS) + 40)
    player = PLAYER(folder / "film.mkv", stage)
    where = {"mpv": lambda: ["mpv", player.path], "vlc": lambda: ["mpris", "vlc"], "kodi": lambda: ["kodi", f"127.0.0.1:{player.port}"],
             "chromium": lambda: ["mpris", player.name]}[player.kind]()
    record = subprocess.Popen([os.environ["RECORD"], *where], stdout=subprocess.PIPE, text=True, env=dict(os.environ, DBUS_SESSION_BUS_ADDRESS=stage.bus.address))
    try:
        time.sleep(0.5)
        player.play()
        time.sleep(SECONDS)
        player.pause()
        time.sleep(1)
        player.play()
        time.sleep(SECONDS)
        player.seek(10.65)
        time.sleep(SECONDS)
        player.rate(2 if PLAYER is Kodi else 1.25)
        time.sleep(SECONDS)
    finally:
        player.kill()
        time.sleep(0.5)
        record.terminate()
        lines = record.stdout.read().splitlines()
        record.wait()
    records = [[line[0], *(int(time) // 1000 if time else "" for time in line[1:4]), *line[4:]] for line in (line.split(",") for line in lines)]
    records += [["frame", int((earliest + latest) / 2 * 1e6), int(position * 1e6)] for earliest, latest, position in stage.screen.frames if latest - earliest < KNOWN_TO]
    records.sort(key=lambda record: record[1])
    begin = records[0][1] - 1_000_000
    for record in records:
        record[1] -= begin
        if record[0] == "report" and record[2] != "":
            record[2] -= begin
    lines = [",".join(str(field) for field in record) for record in records]
    pathlib.Path(sys.argv[2]).write_text("\n".join(lines) + "\n", encoding="utf-8")
finally:
    stage.sound.stop()
    stage.screen.stop()
    stage.bus.stop()
    shutil.rmtree(folder)
