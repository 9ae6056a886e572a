# SPDX-License-Identifier: LGPL-2.1-or-later
"""Players, and how each is told to pause, to seek and to go on."""
import os
import pathlib
import pty
import shutil
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
PYTHON = os.path.realpath(sys.executable)
LIMIT = 20  # s for each step
RATE = 1.5  # to which it is told to go


class Missing(Exception):
    """What a player did not do, as a cell of the table says it."""



class Player:
    """A program that plays films one after the other, and is told nothing while it does."""

    controls = ()

    def __init__(self, label, program, *command):
        self.label, self.program, self.command = label, program, command
        self.process = self.env = None

    def arguments(self, films):
        return [*self.command, *map(str, films[:2])]

    def start(self, films, env, log):
        self.env = env
        self.process = subprocess.Popen(self.arguments(films), env=env, stdout=log, stderr=log, stdin=subprocess.PIPE, cwd=env["HOME"],
                                        start_new_session=True)

    def say(self, control, film):
        raise NotImplementedError

    def leave(self):
        """Asks it to end. gst-launch-1.0 does so by itself."""

    def stop(self):
        """Traces are whole only if the player ends by itself."""
        try:
            self.leave()
            self.process.wait(5)
        except (OSError, Missing, subprocess.TimeoutExpired):
            pass
        for signals in (signal.SIGTERM, signal.SIGKILL):
            try:
                os.killpg(self.process.pid, signals)
                self.process.wait(10)
            except (ProcessLookupError, subprocess.TimeoutExpired):
                continue
            break


class Uri(Player):
    """gst-launch-1.0 playbin."""

    def arguments(self, films):
        return [*self.command, f"uri={films[0].as_uri()}"]


class Terminal(Player):
    """gst-play-1.0: keys in its terminal."""

    controls = ("pause", "resume", "seek", "rate", "track")
    keys = {"pause": b" ", "resume": b" ", "seek": b"\x1b[D", "rate": b"+", "track": b"a"}

    def start(self, films, env, log):
        self.env = env
        self.master, slave = pty.openpty()
        self.process = subprocess.Popen(self.arguments(films), env=env, stdin=slave, stdout=log, stderr=log, cwd=env["HOME"], start_new_session=True)
        os.close(slave)

    def say(self, control, film):
        for _ in range(5 if control == "rate" else 1):  # steps of 0.1, each of which is a seek
            os.write(self.master, self.keys[control])
            time.sleep(0.3)

    def leave(self):
        os.write(self.master, b"q")

    def stop(self):
        super().stop()
        os.close(self.master)


class CommandLine(Player):
    """Totem: a second start tells the first one. Of two films it takes the one that it opens first."""

    controls = ("pause", "resume", "seek")
    options = {"pause": "--pause", "resume": "--play", "seek": "--seek-bwd"}

    def arguments(self, films):
        return [*self.command, str(films[0])]

    def tell(self, *arguments):
        subprocess.run([self.command[0], *arguments], env=self.env | {"GST_TRACERS": ""}, timeout=LIMIT, capture_output=True, check=False)

    def say(self, control, film):
        if control == "seek":
            self.tell("--enqueue", film)
        self.tell(self.options[control])

    def leave(self):
        self.tell("--quit")


class Mpris(Player):
    """By D-Bus: --session org.mpris.MediaPlayer2.NAME."""

    controls = ("pause", "resume", "seek")
    calls = {"pause": ["Player.Pause"], "resume": ["Player.Play"], "seek": ["Player.Seek", "-1500000"]}

    def __init__(self, label, program, name, *command):
        super().__init__(label, program, *command)
        self.name = name

    def call(self, method, *arguments):
        said = subprocess.run(["gdbus", "call", "--session", "--dest", f"org.mpris.MediaPlayer2.{self.name}", "--object-path",
                               "/org/mpris/MediaPlayer2", "--method", f"org.mpris.MediaPlayer2.{method}", "--", *arguments],
                              env=self.env, timeout=LIMIT, capture_output=True, text=True, check=False)
        if said.returncode:
            raise Missing(f"MPRIS: {said.stderr.strip().splitlines()[-1]}")

    def say(self, control, film):
        self.call(*self.calls[control])

    def leave(self):
        self.call("Quit")


class Keys(Player):
    """Parole: D-Bus to play and pause, and a key in its window, which is WIDTH pixels wide. Of a film with several sound tracks it
    shows a bar, which takes all keys."""

    controls = ("pause", "resume", "seek")

    def __init__(self, label, program, width, *command):
        super().__init__(label, program, *command)
        self.width = width

    def say(self, control, film):
        toggle = "gdbus call --session --dest org.Parole.Media.Player --object-path /org/Parole/Media/Player --method org.Parole.Media.Player.Play"
        tells = [PYTHON, HERE / "press_keys.py", str(self.width), "Left"] if control == "seek" else toggle.split()
        subprocess.run(tells, env=self.env, timeout=LIMIT, capture_output=True, check=False)


class Script(Player):
    """A script beside this one: lines on its standard input."""

    controls = ("pause", "resume", "seek", "next")

    def __init__(self, *command, two=False, rate=False):
        super().__init__(*command)
        self.two = two
        self.controls += ("rate",) * rate

    def arguments(self, films):
        return [*self.command, str(films[0]), *([str(films[2])] if self.two else [])]

    def say(self, control, film):
        self.tell({"pause": "pause", "resume": "play", "seek": "seek 0.5", "next": f"open {film}", "rate": f"rate {RATE}"}[control])

    def tell(self, line):
        self.process.stdin.write(f"{line}\n".encode())
        self.process.stdin.flush()

    def leave(self):
        self.tell("quit")


def players():
    python = os.path.basename(PYTHON)
    for name, *options in (("playbin",), ("playbin3", "--use-playbin3"), ("playbin3, gapless", "--use-playbin3", "--gapless")):
        yield Terminal(f"gst-play-1.0, {name}", "gst-play-1.0", "gst-play-1.0", *options)
    yield Uri("gst-launch-1.0 playbin", "gst-launch-1.0", "gst-launch-1.0", "playbin")
    yield CommandLine("Totem", "totem", "totem")
    yield Keys("Parole", "parole", 760, "parole")
    clapper = os.path.basename(os.path.realpath(shutil.which("clapper") or "clapper"))  # 0.5: com.github.rafostar.Clapper
    yield Mpris("Clapper", clapper, "Clapper", "clapper")
    yield Script("GTK 4's GtkVideo", python, PYTHON, HERE / "video_in_gtk.py")
    yield Script("WebKitGTK, two videos", "WebKitWebProcess", PYTHON, HERE / "video_in_page.py", two=True, rate=True)
