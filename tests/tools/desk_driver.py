# SPDX-License-Identifier: LGPL-2.1-or-later
"""tactile-track desk, started and asked. Expects TRACK (tactile-track) and what it needs in the environment."""

import contextlib
import http.client
import json
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import threading
import time
import urllib.parse

_state = tempfile.TemporaryDirectory(prefix="desk-state-", ignore_cleanup_errors=True)
os.environ["XDG_STATE_HOME"] = _state.name  # for addresses; gone at the end
LATEST = 60  # s: until something that has to happen has failed to


def wait_until(what, is_true):
    end = time.monotonic() + LATEST
    while True:
        found = is_true()
        if found:
            return found
        assert time.monotonic() < end, f"waited {LATEST} s in vain for {what}"
        time.sleep(0.01)


def run_gst(line):
    """Without the plugins that are tested: gst-launch-1.0 cannot load those that were built with a sanitizer."""
    env = {name: value for name, value in os.environ.items() if not name.startswith("GST_")}
    subprocess.run(["gst-launch-1.0", "-q", *line.split()], env=env, check=True, timeout=LATEST)


def make_film(path, seconds=8, sound=True, muxer="webmmux", encoder="vp8enc deadline=1 cpu-used=8"):
    """A ball, then at half the time a cut to color bars; a tick each second."""
    picture = "video/x-raw,width=320,height=180,framerate=25/1"
    half = int(seconds * 25 / 2)
    line = f"videotestsrc num-buffers={half} pattern=ball ! {picture} ! c. videotestsrc num-buffers={half} pattern=smpte ! {picture} ! c. concat name=c ! {encoder} ! queue ! {muxer} name=m ! filesink location={path}"
    if sound:
        line += f" audiotestsrc wave=ticks tick-interval=1000000000 samplesperbuffer=480 num-buffers={int(seconds * 100)} ! audio/x-raw,rate=48000,channels=2 ! opusenc ! queue ! m."
    run_gst(line)


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    @property
    def json(self):
        return json.loads(self.body)


class Desk:
    """A desk that runs; `with` ends it as Ctrl-C does."""

    def __init__(self, film, *options, limits=None, env=None):
        self.errors = pathlib.Path(str(film) + ".desk-errors")
        words = [os.environ["TRACK"], "desk", str(film), "--no-browser", "--driver=simulator", *map(str, options)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=self.errors.open("wb"), text=True, preexec_fn=limits, env={**os.environ, **(env or {})})
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            self.process.wait(LATEST)
            raise RuntimeError(f"exit status {self.process.returncode}: {self.errors.read_text()}")
        found = urllib.parse.urlparse(self.address)
        self.port, self.path = found.port, found.path

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self, number=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(number)
        code = self.process.wait(LATEST)
        self.process.stdout.close()
        return code

    def ask(self, method, path, body=None, headers=None):
        """`path` is below the token unless it begins with /."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=LATEST)
        with contextlib.closing(connection):
            if isinstance(body, (dict, list)):
                body = json.dumps(body)
            connection.request(method, path if path.startswith("/") else self.path + path, body, headers or {})
            answer = connection.getresponse()
            return Answer(answer.status, dict(answer.getheaders()), answer.read())

    def get(self, path, **more):
        return self.ask("GET", path, **more)

    def post(self, path, body, **more):
        return self.ask("POST", path, body, **more)

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=LATEST)

    def talk(self, data):
        """What comes back for bytes, until the desk closes."""
        with self.connect() as line:
            line.sendall(data)
            answer = b""
            while True:
                try:
                    piece = line.recv(65536)
                except ConnectionResetError:
                    return answer
                if not piece:
                    return answer
                answer += piece


class Page:
    """What a browser's page does: it listens, and may write."""

    def __init__(self, desk, name, writes=True):
        self.desk, self.name, self.count = desk, name, 0
        self.events, self.open = [], True
        self.line = desk.connect()
        self.line.sendall(f"GET {desk.path}events?page={name} HTTP/1.1\r\nHost: 127.0.0.1:{desk.port}\r\n\r\n".encode())
        self.thread = threading.Thread(target=self._listen, daemon=True)
        self.thread.start()
        wait_until("the first events", lambda: self.last("chair"))
        if writes:
            assert self.desk.post("writer", {"page": name}).json == {"writer": True}

    def _listen(self):
        text = b""
        with contextlib.suppress(OSError):
            while piece := self.line.recv(65536):
                text += piece
                while b"\n\n" in text:
                    event, text = text.split(b"\n\n", 1)
                    lines = dict(line.split(": ", 1) for line in event.decode().splitlines() if ": " in line)
                    if "event" in lines:
                        self.events.append((lines["event"], json.loads(lines["data"])))
        self.open = False

    def last(self, name):
        found = [data for event, data in self.events if event == name]
        return found[-1] if found else None

    def leave(self):
        self.line.shutdown(socket.SHUT_RDWR)
        self.line.close()
        self.thread.join()

    def edit(self, revision, *splices, name=None):
        self.count += 1
        return self.desk.post("edits", {"page": self.name, "edit": name or f"e{self.count}", "revision": revision, "splices": list(splices)})

    def save(self, **more):
        return self.desk.post("save", {"page": self.name, **more})


def cue(start, end, *levels, notes=None):
    found = {"start": start, "end": end, "levels": list(levels)}
    return found | {"notes": notes} if notes else found


def splice(at, remove, *insert):
    return {"at": at, "remove": remove, "insert": list(insert)}
