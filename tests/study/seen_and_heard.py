#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a participant sees and hears while a film plays: an X server's screens, and what PulseAudio's null sink is given.

Usage: seen_and_heard.py [TEST ...]
"""
import contextlib
import os
import re
import signal
import struct
import subprocess
import sys
import threading

from study_page import Server, change, run_gst, small_study, wait_until
from null_sink import RATE, NullSink

BLOCK = RATE // 20  # samples
PINK = (13 / 3) ** 0.5 / 13  # RMS of audiotestsrc's pink noise at volume 1: the mean of 13 numbers, each evenly between -1 and 1


class Display:
    """An X server: 800 x 600 pixels with two screens, "right" and, in the top left corner, "small"."""

    def __init__(self, folder):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-noreset", "-fbdir", str(folder), "-screen", "0", "800x600x24"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read, encoding="ascii") as line:
            self.env = {**os.environ, "DISPLAY": ":" + line.readline().strip()}
        self.memory = folder / "Xvfb_screen0"
        self.run("xrandr", "--setmonitor", "right", "400/100x600/150+400+0", "none")
        self.run("xrandr", "--setmonitor", "small", "80/20x60/15+0+0", "screen")

    def run(self, *words):
        return subprocess.run(words, env=self.env, capture_output=True, text=True, check=True).stdout

    def windows(self):
        """Those of films: position and size, the one that covers the screen and the one in it."""
        tree = subprocess.run(["xwininfo", "-name", "Film", "-tree", "-stats"], env=self.env, capture_output=True, text=True, check=False).stdout
        if "Map State: IsViewable" not in tree:
            return []
        whole = [int(re.search(rf"{name}: +(-?\d+)", tree).group(1)) for name in ("Absolute upper-left X", "Absolute upper-left Y", "Width", "Height")]
        width, height, x, y = map(int, re.search(r"(\d+)x(\d+)\+\d+\+\d+ +\+(\d+)\+(\d+)$", tree, re.MULTILINE).groups())
        return [tuple(whole), (x, y, width, height)]

    def lit(self, x, y, width, height):
        """How many pixels of a rectangle are not black."""
        data = self.memory.read_bytes()  # an X window dump, in the order of a network
        header, = struct.unpack_from(">I", data, 0)
        bytes_per_line, = struct.unpack_from(">I", data, 48)
        colors, = struct.unpack_from(">I", data, 76)
        begin = header + 12 * colors
        return sum(data[at + 1] > 32 for row in range(y, y + height) for at in range(begin + row * bytes_per_line + 4 * x, begin + row * bytes_per_line + 4 * (x + width), 4))

    def stop(self):
        self.server.kill()
        self.server.wait()


class Ear:
    """The level (RMS, of full scale) of each block of the sound that is played."""

    def __init__(self, sound):
        self.levels = []
        self.listener = subprocess.Popen(["parec", f"--server=unix:{sound.socket}", "--device=null.monitor", "--format=s16le", f"--rate={RATE}", "--channels=1", "--raw", "--latency-msec=20"], stdout=subprocess.PIPE)
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        while len(piece := self.listener.stdout.read(2 * BLOCK)) == 2 * BLOCK:
            self.levels.append((sum(sample ** 2 for sample in struct.unpack(f"<{BLOCK}h", piece)) / BLOCK) ** 0.5 / 32768)

    def hears(self, what, is_so, blocks=10):
        """Waits until so many blocks that are played from now on are so, one after the other. Returns them."""
        begin, found = len(self.levels), []

        def look():
            found[:] = next((self.levels[i:i + blocks] for i in range(begin, len(self.levels) - blocks + 1) if all(map(is_so, self.levels[i:i + blocks]))), [])
            return found
        wait_until(what, look)
        return found

    def silence(self, when):
        self.hears(f"silence {when}", lambda level: level == 0)

    def noise(self, when, volume):
        levels = self.hears(f"noise {when}", lambda level: level > 0, blocks=30)
        heard = (sum(level ** 2 for level in levels) / len(levels)) ** 0.5
        assert abs(heard / (volume * PINK) - 1) < 0.2, (when, heard, volume * PINK)
        return heard

    def stop(self):
        self.listener.kill()
        self.listener.wait()


@contextlib.contextmanager
def theatre(noise):
    """A study with a practice film of three seconds and long films; screens and a sound card."""
    with small_study(buffers=3600, rate=1) as folder, contextlib.ExitStack() as stack:
        change(folder, ("film=film.mkv", f"film=film.mkv\nnoise={noise}\n[practice]\nfilm=short.mkv\n"))
        run_gst(f"videotestsrc num-buffers=30 pattern=white ! video/x-raw,width=160,height=120,framerate=10/1 ! vp8enc deadline=1 ! matroskamux ! filesink location={folder}/short.mkv")
        display = Display(folder)
        stack.callback(display.stop)
        yield folder, display, stack


def begin(server, step):
    """The experimenter's start, and all pages up to a film."""
    server.act("start")
    while (now := server.state()["step"])["name"] != step:
        assert server.post("step", {"step": now["name"], "answer": {"consent": "3", "question": "7"}.get(now["kind"], ""), "response": 1}).status == 200


def play(server, step, by_experimenter=False):
    path = server.experimenter.removeprefix(server.address) if by_experimenter else ""
    assert server.post(path + "play", {"step": step}).status == 200


def ended(server):
    wait_until("the end of the film", lambda: server.state()["step"]["phase"] != "playing")


def noise_is_heard_with_films_alone():
    """At its level; silence before a film and after each way out: its end, the experimenter, Escape, SIGTERM, SIGKILL."""
    with theatre(noise=0.3) as (folder, display, stack):
        sound = NullSink(folder)
        stack.callback(sound.stop)
        ear = Ear(sound)
        stack.callback(ear.stop)
        env = {**display.env, "PULSE_SERVER": f"unix:{sound.socket}"}
        with Server(folder, env=env) as server:
            begin(server, "0/film")
            ear.silence("before the film")
            play(server, "0/film")
            level = ear.noise("with the film", 0.3)
            ended(server)
            ear.silence("after the film")
            assert server.post("step", {"step": "0/Q1", "answer": "7", "response": 1}).status == 200
            play(server, "1/film")
            ear.noise("with the first film", 0.3)
            server.act("stop")
            ear.silence("after the experimenter's stop")
            play(server, "1/film", by_experimenter=True)
            ear.noise("again", 0.3)
            display.run("xdotool", "search", "--sync", "--name", "^Film$")
            display.run("xdotool", "key", "Escape")
            ended(server)
            ear.silence("after Escape")
            assert "Escape was pressed" in (folder / "data/P01.journal").read_text()
        for number, name in ((signal.SIGTERM, "SIGTERM"), (signal.SIGKILL, "SIGKILL")):
            server = Server(folder, env=env)
            play(server, "1/film", by_experimenter=True)
            ear.noise(f"before {name}", 0.3)
            server.process.send_signal(number)
            ear.silence(f"after {name}")
            server.process.wait(60)
            server.process.stdout.close()
        print(f"noise=0.3 has a level of {level:.4f} of full scale; expected {0.3 * PINK:.4f}", flush=True)
        assert "no-noise" not in (folder / "data/P01.journal").read_text()


def films_cover_the_screen():
    """The chosen one, black around the film, and nothing of the other; a film that is too large is made smaller."""
    with theatre(noise=0) as (folder, display, _):
        with Server(folder, "--screen=right", env=display.env) as server:
            assert "Films cover the screen right, 400 x 600, of: right, small." in server.errors.read_text(), server.errors.read_text()
            begin(server, "0/film")
            assert not display.windows()
            play(server, "0/film")
            wait_until("the windows", display.windows)
            assert display.windows() == [(400, 0, 400, 600), (520, 240, 160, 120)], display.windows()
            wait_until("the picture", lambda: display.lit(520, 240, 160, 120) == 160 * 120)
            assert display.lit(0, 0, 800, 600) == 160 * 120
            ended(server)
            assert not display.windows()
            assert re.search(r'"frames": [1-9]', (folder / "data/P01.journal").read_text())
            assert server.post("step", {"step": "0/Q1", "answer": "7", "response": 1}).status == 200
            play(server, "1/film")
            wait_until("the windows", display.windows)
            display.run("xdotool", "key", "q")
            ended(server)
            wait_until("no window", lambda: not display.windows())
            assert server.state()["step"]["phase"] == "failed"
        with Server(folder, "--screen=small", env=display.env) as server:
            play(server, "1/film", by_experimenter=True)
            wait_until("the windows", display.windows)
            assert display.windows() == [(0, 0, 80, 60), (0, 0, 80, 60)], display.windows()
            server.act("stop")
        refused = subprocess.run([os.environ["STUDY"], "run", folder, "--no-browser", "--screen=left"], env=display.env, capture_output=True, text=True)
        assert refused.returncode == 2 and "expected --screen=NAME of right, small, got 'left'" in refused.stderr, refused.stderr
        # A screen that is unplugged, and a window that is hidden.
        with Server(folder, "--screen=right", env=display.env) as server:
            display.run("xrandr", "--delmonitor", "right")
            play(server, "1/film", by_experimenter=True)
            ended(server)
            assert "the screen 'right' is gone" in (folder / "data/P01.journal").read_text() and not display.windows()
            display.run("xrandr", "--setmonitor", "right", "400/100x600/150+400+0", "none")
            play(server, "1/film", by_experimenter=True)
            wait_until("the windows", display.windows)
            display.run("xdotool", "search", "--name", "^Film$", "windowunmap")
            ended(server)


def the_chair_stops_first():
    """A film is stopped: motors pause before the masking noise ends, whose sound server may hang."""
    with theatre(noise=0.1) as (folder, display, _):
        log = folder / "states.log"
        log.touch()
        env = {**display.env, "GST_DEBUG": "GST_STATES:5", "GST_DEBUG_FILE": str(log), "GST_DEBUG_NO_COLOR": "1"}
        with Server(folder, env=env) as server:
            begin(server, "0/film")
            play(server, "0/film")
            wait_until("the film and the noise", lambda: all(f"<{name}> completed state change to PLAYING" in log.read_text() for name in ("chair", "audiotestsrc0")))
            before = log.stat().st_size
            server.act("stop")
            wait_until("the end", lambda: server.state()["step"]["phase"] == "failed")
            stopped = log.read_bytes()[before:].decode()
            assert 0 < stopped.index("<chair>") < stopped.index("audiotestsrc0"), stopped[:2000]
            assert "<chair> completed state change to PLAYING" not in stopped, stopped[:2000]
            # The participant's page does not start it again, the experimenter does.
            assert server.post("play", {"step": "0/film"}).status == 409
            assert "doubts" in (folder / "data/P01.journal").read_text()


def each_session_is_checked_before_the_first():
    """A driver that only one level has, with a film that others have, too."""
    with small_study() as folder:
        change(folder, ("[question Q1]", "[level touch on]\ndriver=nosuch\n[question Q1]"))
        answer = subprocess.run([os.environ["STUDY"], "run", folder, "--no-browser", "--no-window"], capture_output=True, text=True, timeout=100)
        assert answer.returncode == 1 and "the settings of a session: driver is one of" in answer.stderr, answer.stderr


TESTS = [each_session_is_checked_before_the_first, noise_is_heard_with_films_alone, films_cover_the_screen, the_chair_stops_first]

if __name__ == "__main__":
    for test in TESTS:
        if not sys.argv[1:] or test.__name__ in sys.argv[1:]:
            test()
            print(f"ok {test.__name__}", flush=True)
