#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The way from the window's start to the first feel with each kind of device, by keys and a screen reader: seconds and decisions, as a page.
Pictures of each step are written to a folder. As root: a gamepad of the kernel's list is a stand-in, in a mount namespace of its own.

Usage: tests/app/installed.sh PACKAGES env GAMEPADS=build/tests/app tests/app/timeline.py FOLDER [WAY ...] >PAGE
or, not installed: meson devenv -C build unshare -m env APP=tools/visuotactile GAMEPADS=tests/app ../tests/app/timeline.py FOLDER [WAY ...] >PAGE"""

import os
import pathlib
import shutil
import subprocess
import sys
import time

os.environ.setdefault("APP", "/usr/bin/visuotactile")
os.environ["PATH"] = f"{os.path.dirname(os.path.abspath(os.environ['APP']))}:{os.environ['PATH']}"

from app_window import App, Atspi, picture, settings, start, wait_until, work  # noqa: E402

HERE = pathlib.Path(__file__).parent
SERVER = HERE.parent / "support/haptic_server.py"
RUMBLE = work / "rumble"  # of the stand-in of SDL
CHAIR = work / "config/visuotactile/chair.conf"
folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)


def rumbles():
    RUMBLE.unlink(missing_ok=True)
    wait_until("a rumble", lambda: RUMBLE.exists() and RUMBLE.read_text(encoding="ascii").count("\n"))


class Way:
    """A user's way: decisions, and times from the window's start."""

    def __init__(self, name, before, **environment):
        self.name = name
        self.before = before  # command lines
        self.decisions = []
        self.times = {}
        self.begin = time.monotonic()
        self.app = App(**environment)
        self.app.find("button", "No hardware")
        self.reach("window")

    def reach(self, step):
        self.times[step] = time.monotonic() - self.begin
        picture(folder / f"{self.name.replace(', film in ', '-')}-{step}.png", 560, 790)

    def decide(self, what, act):
        self.decisions.append(what)
        act()

    def device(self, name):
        if not self.app.find_now("button", name):  # all that is connected is shown at once
            shown = [node.get_name() for node in self.app.all() if node.get_role_name() in ("label", "push button", "button") and node.get_name()]
            found = subprocess.run(["visuotactile-settings", "devices"], capture_output=True, text=True)
            sys.exit(f"the window does not show '{name}', but {shown}; visuotactile-settings devices: {found.stdout}{found.stderr}")
        self.decide("device", lambda: self.app.click("button", name))
        self.app.find("button", name, [Atspi.StateType.PRESSED])

    def test(self, felt):
        self.app.click("button", "Feel all motors")
        felt()
        self.reach("motor")
        self.app.find("button", "Feel all motors")  # the test has ended

    def film(self, felt):
        self.decide("page", lambda: self.app.key("ctrl+2"))
        self.decide("film", lambda: self.app.click("button", "Play an example"))
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
    way.app.find("text", "Device of Intiface")

    def name_it():
        way.app.key("alt+a")
        way.app.find("text", "Device of Intiface", [Atspi.StateType.FOCUSED])
        subprocess.run(["xdotool", "type", "Test Vibrator"], check=True)
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


def connect_gamepad():
    pad = pathlib.Path("/sys/class/input/event3/device")
    if pad.exists():
        return
    subprocess.run(["mount", "-t", "tmpfs", "none", "/sys/class/input"], check=True)
    for name, text in {"name": "Stand-in Gamepad", "capabilities/key": "1000000000000 0 0 0 0", "capabilities/ff": "10000 0", "id/vendor": "045e", "id/product": "02ea", "id/bustype": "3"}.items():
        (pad / name).parent.mkdir(parents=True, exist_ok=True)
        (pad / name).write_text(text + "\n")
    modules = work / "modules"  # with those of the players
    shutil.copytree(os.environ.get("VISUOTACTILE_MODULES") or next(pathlib.Path("/usr/lib").glob("*/visuotactile")), modules, ignore=shutil.ignore_patterns("*.p", "tactor-*"))
    shutil.copy(pathlib.Path(os.environ["GAMEPADS"], "visuotactile-gamepad.so"), modules)
    os.environ.update(VISUOTACTILE_MODULES=str(modules), GAMEPAD_LOG=str(RUMBLE))


def gamepad():
    connect_gamepad()
    way = Way("gamepad", ["visuotactile-play --driver=gamepad FILM"])
    way.device("Stand-in Gamepad")
    way.test(rumbles)
    way.film(rumbles)
    way.end("the kernel's list and SDL are stand-ins")


def gamepad_in(player, switch, section, more, *before):
    """A film that is opened in that player, as by the file manager."""
    connect_gamepad()
    film = work / "film.mkv"
    subprocess.run(f"gst-launch-1.0 -q tactiletestsrc num-buffers=1800 ! video/x-raw,width=320,height=240 ! jpegenc ! matroskamux ! filesink location={film}".split(), check=True)
    way = Way(f"gamepad, film in {player}", [*before, f"{player} FILM"])
    way.device("Stand-in Gamepad")
    way.decide("page", lambda: way.app.key("ctrl+3"))
    way.decide(switch, lambda: way.app.click("check box", switch))
    wait_until("the switch", section)
    viewer = []
    way.decide("film", lambda: viewer.append(start(player, *more, film, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)))
    rumbles()
    way.reach("film")
    viewer[0].terminate()
    viewer[0].wait()
    way.end("the kernel's list and SDL are stand-ins")


def totem():
    gamepad_in("totem", "Totem", lambda: "[totem]" in settings(), [], "visuotactile-settings set driver=gamepad", "visuotactile-settings on totem")


def mpv():
    gamepad_in("mpv", "mpv", (work / "config/mpv/scripts/visuotactile.lua").is_symlink, ["--vo=x11", "--ao=null"],
               "mkdir -p ~/.config/mpv/scripts", "cp /usr/share/visuotactile/mpv/visuotactile.lua ~/.config/mpv/scripts", "visuotactile-settings set driver=gamepad")


def nothing():
    way = Way("nothing", ["visuotactile-play"])
    way.device("No hardware")
    way.test(lambda: way.app.find("label", "row "))
    way.film(lambda: way.app.find("label", "The chair plays"))
    way.end("seen, not felt")


WAYS = {way.__name__: way for way in (gamepad, totem, mpv, vest, intiface, shaker, nothing)}
where = os.environ.get("INSTALLED") or "The programs are those of a build folder."
print(f"""# First feel

Made by `tests/app/timeline.py FOLDER {" ".join(sys.argv[2:] or WAYS)}`; do not edit.

{where} {os.cpu_count()} CPUs, load average {os.getloadavg()[0]:.1f} at the start, Xvfb. The window is used by keys and
AT-SPI, without a terminal, as soon as the test finds what it shows. Times are seconds from the start of the window. The first motor is that
of the feel test, which plays to its end before the film is chosen.

Decisions in a terminal: the terminal, and each word of the lines in the guide before the window (commit 3908735e^). In
the window: each choice on the way to the film. The feel test is in neither.

| device | in a terminal | in the window | window | first motor | first feel of a film | |
|---|---|---|---|---|---|---|""", flush=True)
for chosen in sys.argv[2:] or WAYS:
    CHAIR.unlink(missing_ok=True)
    WAYS[chosen]()
