#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The way from the window's start to the first feel with each kind of device, as a table: seconds and decisions. Pictures of each step are
written to a folder. As root: a gamepad of the kernel's list is a stand-in, in a mount namespace of its own.

Usage: meson devenv -C build unshare -m env APP=tools/visuotactile GAMEPADS=tests/app python3 ../tests/app/timeline.py FOLDER [PATH ...]"""

import os
import pathlib
import subprocess
import sys
import time

from app_window import App, Atspi, picture, start, wait_until, work

HERE = pathlib.Path(__file__).parent
SERVER = HERE.parent / "support/haptic_server.py"
folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)


class Way:
    """A user's way: decisions, and times from the window's start."""

    def __init__(self, name, **environment):
        self.name = name
        self.decisions = []
        self.times = {}
        self.begin = time.monotonic()
        self.app = App(**environment)
        self.app.find("toggle button", "The board")
        self.reach("window")

    def reach(self, step):
        self.times[step] = time.monotonic() - self.begin
        picture(folder / f"{self.name}-{step}.png", 560, 790)

    def decide(self, what, act):
        self.decisions.append(what)
        act()

    def device(self, name):
        self.app.find("toggle button", name)
        self.decide("device", lambda: self.app.click("toggle button", name))
        self.app.find("toggle button", name, [Atspi.StateType.PRESSED])

    def test(self, felt):
        self.app.click("push button", "Feel all motors")
        felt()
        self.reach("motor")
        self.app.click("push button", "Stop the feel test")
        self.app.find("push button", "Feel all motors")

    def film(self, felt):
        self.decide("page", lambda: self.app.key("ctrl+2"))
        self.decide("film", lambda: self.app.click("push button", "Play an example"))
        felt()
        self.reach("film")

    def end(self, note=""):
        self.app.quit()
        times = " | ".join(f"{self.times[step]:.0f}" if step in self.times else "" for step in ("window", "motor", "film"))
        print(f"| {self.name} | {len(self.decisions)}: {', '.join(self.decisions)} | {times} | {note} |", flush=True)


def server_of(kind, port):
    server = start(sys.executable, SERVER, kind, f"port={port}", stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert server.stdout.readline().split()[-1] == str(port)

    def felt():
        while not (line := server.stdout.readline()).startswith("motors") or "=" not in line:
            assert line, "the server has ended"

    return felt


def vest():
    felt = server_of("bhaptics", 15881)
    way = Way("vest")
    way.device("Vest of bHaptics, back")
    way.test(felt)
    way.film(felt)
    way.end("bHaptics Player is a stand-in")


def intiface():
    felt = server_of("buttplug4", 12345)
    way = Way("intiface")
    entry = way.app.find("text", "Device of Intiface")

    def name_it():
        entry.set_text_contents("Test Vibrator")
        entry.grab_focus()
        way.app.key("Return")

    way.decide("name of the device", name_it)
    way.app.find("toggle button", "Test Vibrator of Intiface", [Atspi.StateType.PRESSED])
    way.test(felt)
    way.film(felt)
    way.end("Intiface is a stand-in")


def shaker():
    start("pulseaudio", "-n", "--exit-idle-time=-1", "--disable-shm", "--load=module-native-protocol-unix", "--load=module-null-sink sink_name=shaker sink_properties=device.description=Shaker",
          stderr=subprocess.DEVNULL)
    wait_until("the sound server", lambda: subprocess.run(["pactl", "info"], capture_output=True).returncode == 0)
    heard = start("parec", "--device=shaker.monitor", "--format=s16le", "--latency-msec=20", stdout=subprocess.PIPE)

    def felt():
        while not any(heard.stdout.read1(65536)):
            pass

    way = Way("shaker")
    way.device("Shakers at the sound card")
    way.test(felt)
    way.film(felt)
    way.end("the sound card is PulseAudio's null sink")


def gamepad():
    pad = pathlib.Path("/sys/class/input/event3/device")
    subprocess.run(["mount", "-t", "tmpfs", "none", "/sys/class/input"], check=True)
    for name, text in {"name": "Stand-in Gamepad", "capabilities/key": "1000000000000 0 0 0 0", "capabilities/ff": "10000 0", "id/vendor": "045e", "id/product": "02ea", "id/bustype": "3"}.items():
        (pad / name).parent.mkdir(parents=True, exist_ok=True)
        (pad / name).write_text(text + "\n")
    log = work / "rumble"

    def felt():
        log.unlink(missing_ok=True)
        wait_until("a rumble", lambda: log.exists() and log.read_text().count("\n"))

    way = Way("gamepad", VISUOTACTILE_MODULES=os.path.abspath(os.environ["GAMEPADS"]), GAMEPAD_LOG=str(log))
    way.device("Stand-in Gamepad")
    way.test(felt)
    way.film(felt)
    way.end("the kernel's list and SDL are stand-ins")


def nothing():
    way = Way("nothing")
    way.device("No hardware")
    way.test(lambda: way.app.find("label", "row 1, column 1"))
    way.film(lambda: way.app.find("label", "The chair plays"))
    way.end("seen, not felt")


WAYS = {way.__name__: way for way in (gamepad, vest, intiface, shaker, nothing)}
print("| device | decisions | window, s | first motor, s | first feel of a film, s | |\n|---|---|---|---|---|---|")
for chosen in sys.argv[2:] or WAYS:
    file = work / "config/visuotactile/chair.conf"
    file.unlink(missing_ok=True)
    WAYS[chosen]()
