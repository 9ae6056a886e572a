# SPDX-License-Identifier: LGPL-2.1-or-later
"""A real mpv without picture and sound, what follows it, and a vest in memory, which says what its motors do. Buses, settings and caches are the
test's own.

Expects FOLLOW, SERVER (haptic_server.py), the plugins on GST_PLUGIN_PATH, mpv and dbus-daemon."""

import atexit
import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

from mpv_socket import MpvSocket

FOLLOW = os.environ["FOLLOW"]
LATEST = 60  # s: until something that has to happen has failed to
NAME, PATH = "org.visuotactile.Follow1", "/org/visuotactile/Follow1"

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-follow-service-"))
started = []
helpers = []  # programs without which there is nothing to wait for


def wait_until(what, is_true):
    end = time.monotonic() + LATEST
    while not is_true():
        for helper in helpers:
            assert helper.poll() is None, f"{' '.join(helper.args)} ended with status {helper.returncode} (see above); waited for {what}"
        assert time.monotonic() < end, f"waited {LATEST} s in vain for {what() if callable(what) else what}"
        time.sleep(0.01)


def start(*words, **options):
    process = subprocess.Popen(words, **options)
    started.append(process)
    return process


def start_bus(environment=None):
    """A bus of its own: the process and its address."""
    bus = start("dbus-daemon", "--session", "--nofork", "--print-address", stdout=subprocess.PIPE, text=True, env=environment)
    return bus, bus.stdout.readline().strip()


class Mpv(MpvSocket):
    def __init__(self, film, *options):
        super().__init__(str(work / "mpv.sock"))
        pathlib.Path(self.path).unlink(missing_ok=True)
        self.process = start("mpv", "--no-config", "--vo=null", "--ao=null", f"--input-ipc-server={self.path}", *options, str(film),
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until("mpv's socket", self.connects)

    def quit(self):
        self.command("quit")
        self.process.wait(LATEST)


class Vest:
    """What the motors of a vest do: lines of haptic_server.py, and when they came."""

    def __init__(self):
        self.server = start("/usr/bin/python3", os.environ["SERVER"], "bhaptics", stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        port = self.server.stdout.readline()
        assert port.startswith("port "), "haptic_server.py ended before it was ready (see above)"
        self.device = f"vest-back@127.0.0.1:{port.split()[1]}"
        helpers.append(self.server)
        self.lines = []
        self.opened = []  # times of connections
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        for line in self.server.stdout:
            if line == "open\n":
                self.opened.append(time.monotonic())
            # What was not ended in time on a busy computer expires.
            if line.startswith(("motors", "expired")):
                self.lines.append((time.monotonic(), line.startswith("motors") and len(line.split()) > 2))

    def wait_to_feel(self):
        after = time.monotonic()
        wait_until("something that is felt", lambda: any(on for at, on in self.lines if at > after))

    def is_silent(self):
        return not self.lines or not self.lines[-1][1]


# Like a user, who may not raise a thread's priority again.
AS_USER = ["setpriv", "--bounding-set=-sys_nice", "--inh-caps=-sys_nice"] if os.geteuid() == 0 else []


class Follower:
    def __init__(self, mpv, *options):
        self.log = work / "log"
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = start(*AS_USER, FOLLOW, f"--mpv={mpv.path}", "--driver=bhaptics", f"--device={vest.device}", *options, stderr=log)

    def said(self):
        return self.log.read_text(encoding="utf-8")

    def wait_for(self, text):
        wait_until(lambda: f"'{text}' in: {self.said()}", lambda: text in self.said() or self.process.poll() is not None)
        assert text in self.said(), self.said()

    def end(self, status=0):
        if status == 0:
            self.process.send_signal(signal.SIGINT)
        assert self.process.wait(LATEST) == status, self.said()
        assert "CRITICAL" not in self.said(), self.said()
        wait_until("silence", vest.is_silent)


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


def make_wrapper(arguments):
    """A visuotactile-follow for PATH, which notes how it is called."""
    wrapper = work / "bin" / "visuotactile-follow"
    wrapper.parent.mkdir(exist_ok=True)
    wrapper.write_text(f"""#!/bin/sh
echo "$@" >>{work}/calls
if [ "$1" = --status ]; then
  {FOLLOW} --status 2>>{work}/log
  status=$?
  echo "status $status" >>{work}/calls
  exit $status
fi
exec {FOLLOW} {arguments} 2>>{work}/log
""", encoding="utf-8")
    wrapper.chmod(0o755)
    (work / "calls").write_text("", encoding="utf-8")
    return wrapper


def run(parts):
    """Those that the command line names, or all."""
    for part in sys.argv[1:] or parts:
        begin = time.monotonic()
        parts[part]()
        print(f"{part}: {time.monotonic() - begin:.1f} s", flush=True)


def end():
    for process in started:
        with contextlib.suppress(ProcessLookupError):
            # With what it started, where it has a session of its own.
            (os.killpg if os.getpgid(process.pid) == process.pid else os.kill)(process.pid, signal.SIGKILL)
        process.wait()
    shutil.rmtree(work)


atexit.register(end)
session, os.environ["DBUS_SESSION_BUS_ADDRESS"] = start_bus()
_, os.environ["DBUS_SYSTEM_BUS_ADDRESS"] = start_bus()
os.environ["XDG_CACHE_HOME"], os.environ["XDG_CONFIG_HOME"] = str(work / "cache"), str(work / "config")
vest = Vest()
