#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""visuotactile-follow and players that python3-dbusmock programs (mpris_template.py): their positions are old, unsteady, rounded, and of another clock. When a motor is at its level, by the commands in the trace, against where the programmed film is.

Expects FOLLOW, the plugins on GST_PLUGIN_PATH, python3-dbusmock and dbus-daemon."""

import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from follow_players import LATEST, Bus, wait_until
from follow_trace import make_track, onsets, read_trace

TEMPLATE = pathlib.Path(__file__).with_name("mpris_template.py")
SETTLED = 5  # s after the beginning
PULSES = 5
# A name that VLC has lets it be known that the position is renewed now and then.
PLAYERS = {
    "steady": {"clock": 1.0003, "renewed": 0.002, "jitter": 0, "rounded": 1e-6},
    "unsteady": {"clock": 0.9997, "renewed": 0.002, "jitter": 0.01, "rounded": 0.001},
    "vlc": {"clock": 1.0003, "renewed": 0.25, "jitter": 0.04, "rounded": 0.001},
    "milliseconds": {"clock": 1, "renewed": 0.002, "jitter": 0, "rounded": 0.001, "second": 1000},  # instead of microseconds, and as a double
}
MOST = 0.025  # s

folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-mpris-"))
env = dict(os.environ, HOME=str(folder), XDG_CONFIG_HOME=str(folder / "config"), XDG_CACHE_HOME=str(folder / "cache"), XDG_RUNTIME_DIR=str(folder))
bus = Bus(folder)
env["DBUS_SESSION_BUS_ADDRESS"] = bus.address
started, followers = [], []
try:
    make_track(folder / "film.csv", [(second, 0.35) for second in range(1, 60)], 60)
    begin = time.monotonic()
    for name, how in PLAYERS.items():
        words = {"begin": begin, "film": f"file://{folder}/film.mkv", **how}
        source = TEMPLATE.read_text(encoding="utf-8").replace("MediaPlayer2.mock", f"MediaPlayer2.{name}")
        template = folder / f"{name}.py"
        template.write_text(source, encoding="utf-8")
        parameters = "{" + ", ".join(f'"{key}": "{value}"' for key, value in words.items()) + "}"
        started.append(subprocess.Popen([sys.executable, "-m", "dbusmock", "--session", "--template", str(template), "--parameters", parameters], env=env,
                                        stdout=subprocess.DEVNULL))
        followers.append(subprocess.Popen([os.environ["FOLLOW"], f"--mpris={name}", "--driver=simulator", "--no-drafts", f"--trace={folder / name}.csv"], env=env))
    now = lambda how: (time.monotonic() - begin) * how["clock"]
    wait_until("the pulses", lambda: now(PLAYERS["vlc"]) > SETTLED + PULSES + 1)
    for follower in followers:
        follower.terminate()
        assert follower.wait(LATEST) == 0, follower.returncode
    print("| player | pulses | p50 | most |\n|---|---|---|---|")
    for name, how in PLAYERS.items():
        places = [(effect - begin) * how["clock"] for effect in onsets(read_trace(folder / f"{name}.csv"))]
        errors = [place - round(place) for place in places if SETTLED < place < SETTLED + PULSES]
        assert len(errors) >= PULSES - 1, f"{name}: {len(errors)} pulses"
        print(f"| {name} | {len(errors)} | {1000 * statistics.median(errors):+.1f} ms | {1000 * max(errors, key=abs):+.1f} ms |", flush=True)
        assert abs(statistics.median(errors)) < MOST, f"{name}: off by {1000 * statistics.median(errors):.1f} ms"
finally:
    for process in started + followers:
        process.kill()
        process.wait()
    bus.stop()
    shutil.rmtree(folder)
