#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The way from the window's start to the first feel with each kind of device, by keys and a screen reader: seconds and decisions, as a page.
Pictures of each step are written to a folder. As root: a gamepad of the kernel's list is a stand-in, in a mount namespace of its own.

Usage: meson devenv -C build unshare -m env APP=tools/visuotactile GAMEPADS=tests/app python3 ../tests/app/timeline.py FOLDER [WAY ...] >PAGE"""

import os
import pathlib
import subprocess
import sys
import time

from app_window import App, Atspi, picture, start, wait_until, work

HERE = pathlib.Path(__file__).parent
SERVER = HERE.parent / "support/haptic_server.py"
CHAIR = work / "config/visuotactile/chair.conf"
folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)


class Way:
    """A user's way: decisions, and times from the window's start."""

    def __init__(self, name, before, **environment):
        self.name = name
        self.before = before  # command lines
        self.decisions = []
        self.times = {}
        self.begin = time.monotonic()
        self.app = App(**environment)
        self.app.find("button", "The board")
        self.reach("window")

    def reach(self, step):
        self.times[step] = time.monotonic() - self.begin
        picture(folder / f"{self.name.replace(' ', '-')}-{step}.png", 560, 790)

    def decide(self, what, act):
        self.decisions.append(what)
        act()

    def device(self, name):
        self.app.find("button", name)
        self.decide("device", lambda: self.app.click("button", name))
        self.app.find("button", name, [Atspi.StateType.PRESSED])

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
        times = " | ".join(f"{self.times[step]:.0f}" if step in self.times else "–" for step in ("window", "motor", "film"))
        words = 1 + sum(len(line.split()) for line in self.before)  # a terminal
        lines = ", ".join(f"`{line}`" for line in self.before)
        print(f"| {self.name} | {words}: a terminal, {lines} | {len(self.decisions)}: {', '.join(self.decisions)} | {times} | {note} |", flush=True)


def server_of(kind, port):
    server = start(sys.executable, SERVER, kind, f"port={port}", stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert server.stdout.readline().split()[-1] == str(port)

    def felt():
        while not (line := server.stdout.readline()).startswith("motors") or "=" not in line:
            assert line, "the server has ended"

    return felt


def vest():
    felt = server_of("bhaptics", 15881)
    way = Way("vest", ["visuotactile-play --driver=bhaptics FILM"])
    way.device("Vest of bHaptics, back")
    way.test(felt)
    way.film(felt)
    way.end("bHaptics Player is a stand-in")


def intiface():
    felt = server_of("buttplug4", 12345)
    way = Way("Intiface", ["visuotactile-play --driver=intiface --device=NAME FILM"])
    entry = way.app.find("text", "Device of Intiface")

    def name_it():
        entry.set_text_contents("Test Vibrator")
        entry.grab_focus()
        way.app.key("Return")

    way.decide("name of the device", name_it)
    way.app.find("button", "Test Vibrator of Intiface", [Atspi.StateType.PRESSED])
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

    way = Way("shaker", ["visuotactile-play --driver=audio FILM"])
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

    os.environ.update(VISUOTACTILE_MODULES=os.path.abspath(os.environ["GAMEPADS"]), GAMEPAD_LOG=str(log))
    way = Way("gamepad", ["visuotactile-play --driver=gamepad FILM"])
    way.device("Stand-in Gamepad")
    way.test(felt)
    way.film(felt)
    way.end("the kernel's list and SDL are stand-ins")

    CHAIR.unlink()
    film = work / "film.mkv"
    subprocess.run(f"gst-launch-1.0 -q tactiletestsrc num-buffers=1800 ! video/x-raw,width=160,height=120 ! jpegenc ! matroskamux ! filesink location={film}".split(), check=True)
    way = Way("gamepad in Totem", ["visuotactile-settings set driver=gamepad", "visuotactile-settings on totem", "totem FILM"])
    way.device("Stand-in Gamepad")
    way.decide("page", lambda: way.app.key("ctrl+3"))
    way.decide("Totem", lambda: way.app.click("check box", "Totem"))
    wait_until("Totem's section", lambda: "[totem]" in CHAIR.read_text(encoding="utf-8"))
    way.decide("film", lambda: start("totem", film, stderr=subprocess.DEVNULL))
    felt()
    way.reach("film")
    way.end("likewise; the film is opened as by the file manager")


def nothing():
    way = Way("nothing", ["visuotactile-play"])
    way.device("No hardware")
    way.test(lambda: way.app.find("label", "row 1, column 1"))
    way.film(lambda: way.app.find("label", "The chair plays"))
    way.end("seen, not felt")


WAYS = {way.__name__: way for way in (gamepad, vest, intiface, shaker, nothing)}
print(f"""# First feel

Made by `tests/app/timeline.py FOLDER {" ".join(sys.argv[2:] or WAYS)}`; do not edit.

{os.cpu_count()} CPUs, load average {os.getloadavg()[0]:.1f} at the start, Xvfb. The test uses the window by keys and AT-SPI, without a terminal. Times are seconds from the start of the window, and most of them
are the test's own walks over AT-SPI. The first motor is that of the feel test. The installation of the package is not timed.

Decisions in a terminal: the terminal, and each word. In the window: each choice.

| device | in a terminal | in the window | window | first motor | first feel of a film | |
|---|---|---|---|---|---|---|""", flush=True)
for chosen in sys.argv[2:] or WAYS:
    CHAIR.unlink(missing_ok=True)
    WAYS[chosen]()
