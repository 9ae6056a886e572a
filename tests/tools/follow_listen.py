#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""visuotactile-follow --listen: a film is known by its sound in a folder of entries and on a web server, another sound is not, and what cannot be
used is said. By ear a real mpv at PulseAudio's null sink is felt when it is by mpv's own report.

Expects what follow_stage.py does, TRACK, ffmpeg and pulseaudio.
Usage: follow_listen.py [PART ...]      of file, hang, learn, saver, server and, by hand on an idle computer, player; all by default"""

import contextlib
import functools
import hashlib
import http.server
import json
import os
import resource
import signal
import socket
import statistics
import subprocess
import threading

import follow_trace
from film_sound import make_sound
from follow_stage import FOLLOW, LATEST, Mpv, run, start, started, wait_until, work
from null_sink import NullSink

TRACK = os.environ["TRACK"]
SECONDS = 60
FIRST = 20  # s: where the film is heard from


def track(*words):
    done = subprocess.run([TRACK, *map(str, words)], capture_output=True, text=True, check=False, timeout=LATEST)
    assert done.returncode == 0, done
    return done.stdout


def learn_film(name, sound, folder, seconds):
    """A film of this sound with its entry: a pulse in each second."""
    film = work / f"{name}.mkv"
    subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", f"color=black:s=64x64:r=25:d={seconds}", "-i", str(sound), "-c:v", "libx264", "-preset",
                    "ultrafast", "-c:a", "aac", "-b:a", "128k", str(film)], check=True)
    follow_trace.make_track(folder / f"{name}.csv", [(second, 0.7) for second in range(1, seconds)], seconds)
    said = track("learn", film, folder / f"{name}.csv")
    assert f"{name}.heard" in said, said
    return film


@functools.cache
def make_film():
    library = work / "library"
    library.mkdir()
    sound = make_sound(work / "film.wav", 5, SECONDS)
    film = learn_film("Known", sound, library, SECONDS)
    assert (library / "Known.heard").stat().st_size < 40_000
    heard = work / "heard.wav"
    subprocess.run(["ffmpeg", "-v", "error", "-ss", str(FIRST), "-i", str(sound), "-t", "20", str(heard)], check=True)
    return film, library, heard


def set_saver(is_on):
    subprocess.run(["gdbus", "emit", "--session", "--object-path=/org/freedesktop/ScreenSaver", "--signal=org.freedesktop.ScreenSaver.ActiveChanged",
                    str(is_on).lower()], check=True)


class Listener:
    def __init__(self, name, *options, environment=None):
        self.log, self.trace = work / f"{name}.log", work / f"{name}.csv"
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = start(FOLLOW, "--driver=simulator", f"--trace={self.trace}", "--once", *map(str, options), stderr=log, env=environment)

    def said(self):
        return self.log.read_text(encoding="utf-8")

    def wait_for(self, text):
        wait_until(lambda: f"'{text}' in: {self.said()}", lambda: text in self.said() or self.process.poll() is not None)
        assert text in self.said(), self.said()

    def end(self):
        """Of the sound, or now."""
        self.process.wait(LATEST)
        assert self.process.returncode == 0 and "CRITICAL" not in self.said(), self.said()

    def onsets(self):
        return follow_trace.onsets(follow_trace.read_trace(self.trace))


def file():
    _, library, heard = make_film()
    (library / "Torn.heard").write_bytes((library / "Known.heard").read_bytes()[:1000])
    listener = Listener("file", f"--listen={heard}", f"--tracks={library}", "--mpv=/nowhere")
    listener.wait_for("listens to '")
    assert "Torn.heard': expected" in listener.said(), listener.said()
    listener.wait_for("plays 'Known.mkv' with the track of its entry")
    listener.end()
    assert "the sound has ended" in listener.said(), listener.said()
    assert len(listener.onsets()) >= 5, listener.onsets()  # when they come: part player, by hand
    (library / "Torn.heard").unlink()
    # Another film.
    other = make_sound(work / "other.wav", 6, 12)
    listener = Listener("other", f"--listen={other}", f"--tracks={library}", "--mpv=/nowhere")
    listener.end()
    assert "plays '" not in listener.said(), listener.said()
    # A file that cannot be decoded, alone and with a player that has not played.
    text = work / "text.wav"
    text.write_text("no sound", encoding="utf-8")
    paused = Mpv(other, "--pause")
    for mpv in ("/nowhere", paused.path):
        listener = Listener("text", f"--listen={text}", f"--tracks={library}", f"--mpv={mpv}")
        listener.end()
        assert "cannot listen to '" in listener.said() and (" is there" in listener.said()) == (mpv == paused.path), listener.said()
    paused.quit()
    # No microphone is no silence, and no source is listened to before it has sound.
    for source in ("--listen", "--listen=nowhere"):
        listener = Listener("deaf", source, f"--tracks={library}", "--mpv=/nowhere", environment=dict(os.environ, PULSE_SERVER="unix:/nowhere"))
        listener.wait_for("cannot listen to ")
        listener.process.send_signal(signal.SIGINT)
        listener.end()
        assert "listens to" not in listener.said(), listener.said()
    lacking = Listener("lacking", "--listen", "--mpv=/nowhere")
    assert lacking.process.wait(LATEST) == 2 and "--listen needs --tracks" in lacking.said(), lacking.said()
    # No entries at first: it tries again, and --once goes on. A film that is learned while it listens is known after.
    late = work / "late"
    late.mkdir()
    listener = Listener("late", f"--listen={heard}", f"--tracks={late}", "--mpv=/nowhere")
    listener.wait_for("make them with tactile-track learn")
    learn_film("Other", other, late, 12)
    listener.wait_for("listens to '")
    (late / "Known.new").write_bytes((library / "Known.heard").read_bytes())
    (late / "Known.new").rename(late / "Known.heard")
    listener.wait_for("plays 'Known.mkv' with the track of its entry")
    listener.end()


class DeafServer:
    """A sound server that answers nothing."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.bind(str(path))
        self.socket.listen()
        self.connections, self.closed = [], False
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        while True:
            connection, _ = self.socket.accept()
            self.connections.append(connection)
            while connection.recv(1 << 16):
                pass
            self.closed = True


def hang():
    """A sound server that hangs holds neither another player's film nor the end."""
    film, library, _ = make_film()
    deaf = DeafServer(work / "deaf.socket")
    mpv = Mpv(film)
    listener = Listener("hang", "--listen=null.monitor", f"--tracks={library}", f"--mpv={mpv.path}", "--no-drafts",
                        environment=dict(os.environ, PULSE_SERVER=f"unix:{work}/deaf.socket"))
    listener.wait_for("plays 'Known.mkv' with '")
    wait_until("a connection", lambda: deaf.connections)
    set_saver(True)
    listener.wait_for("the screen saver is on")
    assert not deaf.closed, "it waited for the sound server"
    set_saver(False)
    listener.wait_for("the chair is used again")
    listener.process.send_signal(signal.SIGINT)
    listener.end()
    mpv.quit()


def saver():
    """The saver does not start while a film is heard; nothing holds it back after. The saver is a mock."""
    _, library, heard = make_film()
    name, path, log = "org.freedesktop.ScreenSaver", "/org/freedesktop/ScreenSaver", work / "saver.log"
    start("/usr/bin/python3", "-m", "dbusmock", "--logfile", str(log), name, path, name)

    def call(*words):
        return subprocess.run(["gdbus", "call", "--session", f"--dest={name}", f"--object-path={path}", *words], capture_output=True, check=False).returncode == 0

    wait_until("the mock", lambda: call("--method=org.freedesktop.DBus.Peer.Ping"))
    for method, takes, gives, code in ("Inhibit", "ss", "u", "ret = 7"), ("UnInhibit", "u", "", ""):
        assert call("--method=org.freedesktop.DBus.Mock.AddMethod", name, method, takes, gives, code)
    listener = Listener("saver", f"--listen={heard}", f"--tracks={library}", "--mpv=/nowhere")
    listener.wait_for("plays 'Known.mkv' with the track of its entry")
    wait_until("Inhibit", lambda: ' Inhibit "visuotactile-follow"' in log.read_text(encoding="utf-8"))
    assert "UnInhibit" not in log.read_text(encoding="utf-8")
    set_saver(True)  # by hand
    wait_until("UnInhibit", lambda: " UnInhibit 7" in log.read_text(encoding="utf-8"))
    listener.process.send_signal(signal.SIGINT)
    listener.end()


def learn():
    """A time stamp of 20 hours allocates no such silence."""
    film, map_track = work / "leap.mkv", work / "leap.csv"
    subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", "color=black:s=64x64:r=25:d=4", "-f", "lavfi", "-i", "sine=d=4",
                    "-af", "asetpts=if(gt(T\\,2)\\,PTS+72000/TB\\,PTS)", "-c:v", "libx264", "-preset", "ultrafast", "-c:a", "pcm_s16le", str(film)], check=True)
    follow_trace.make_track(map_track, [(1, 0.7)], 4)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    done = subprocess.run([TRACK, "learn", str(film), str(map_track)], capture_output=True, text=True, check=False, timeout=LATEST)
    assert done.returncode == 1 and "expected a film of at most 10 hours" in done.stderr, done
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    assert most < 500 << 10, f"{most} KiB, {before} KiB before"


def server():
    _, library, heard = make_film()
    assert "1 tracks" in track("index", library)
    assert ".heard" not in json.loads((library / "tracks.json").read_text(encoding="utf-8"))["tracks"][0].get("film", ""), "an entry is no film"
    requests = []

    class Handler(http.server.SimpleHTTPRequestHandler):
        def do_GET(self):
            requests.append(self.path)
            super().do_GET()

        def log_message(self, *_):
            pass

    web = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=library))
    threading.Thread(target=web.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{web.server_port}"
    # Each look for entries finds the same fault, which is reported once.
    torn = library / "torn"
    torn.mkdir()
    (torn / "Torn.heard").write_bytes(b"torn")
    (torn / "tracks.json").write_text(json.dumps({"tracks": [{"file": "Torn.csv", "duration": 1, "heard": "Torn.heard",
                                                              "heard_sum": hashlib.sha256(b"torn").hexdigest()}]}), encoding="utf-8")
    listener = Listener("torn", f"--listen={heard}", f"--tracks={address}/torn", "--mpv=/nowhere")
    wait_until("three looks", lambda: requests.count("/torn/tracks.json") == 3)
    listener.process.send_signal(signal.SIGINT)
    listener.end()
    assert listener.said().count(f"no film can be listened for: '{address}/torn/Torn.heard': expected") == listener.said().count("Torn.heard") == 1, listener.said()
    kept = work / "cache/visuotactile/heard"
    assert not kept.exists() or not list(kept.iterdir()), "what is no entry is not kept"
    requests.clear()
    for time in range(2):  # the second time it is kept
        listener = Listener(f"server{time}", f"--listen={heard}", f"--tracks={address}", "--mpv=/nowhere")
        listener.wait_for("plays 'Known.mkv' with the track of its entry")
        listener.process.send_signal(signal.SIGINT)
        listener.end()
    assert requests == ["/tracks.json", "/Known.heard", "/tracks.json"], requests
    web.shutdown()
    (library / "tracks.json").unlink()


def player():
    """What is felt by ear and by mpv's report."""
    film, library, _ = make_film()
    sound = NullSink(work)
    started.append(sound.process)
    os.environ["PULSE_SERVER"] = f"unix:{sound.socket}"
    mpv = Mpv(film, "--ao=pulse", "--audio-device=pulse/null", "--start=5", "--end=45", "--pause")
    by_ear = Listener("ear", "--listen=null.monitor", f"--tracks={library}", "--mpv=/nowhere")
    by_report = Listener("report", f"--mpv={mpv.path}", f"--tracks={library}", "--no-drafts")
    both = Listener("both", "--listen=null.monitor", f"--mpv={mpv.path}", f"--tracks={library}", "--no-drafts")
    for listener in (by_ear, both):
        listener.wait_for("listens to 'null.monitor'")
    by_report.wait_for("plays 'Known.mkv' with '")
    mpv.command("set_property", "pause", False)
    by_ear.wait_for("plays 'Known.mkv' with the track of its entry")
    mpv.process.wait(LATEST)
    for listener in (by_ear, by_report, both):
        with contextlib.suppress(ProcessLookupError):
            listener.process.send_signal(signal.SIGINT)  # it may have ended with mpv
        listener.end()
    truth = by_report.onsets()
    off = [min((at - other for other in truth), key=abs) * 1000 for at in by_ear.onsets() if truth[0] - 0.5 < at < truth[-1] + 0.5]
    sizes = sorted(map(abs, off))
    print(f"{len(off)} pulses by ear against mpv's report: median {statistics.median(off):+.1f} ms, p95 {sizes[len(sizes) * 95 // 100]:.1f} ms")
    assert len(off) >= 5 and abs(statistics.median(off)) < 100, off
    # mpv reports its position, so it is followed.
    off = [min(abs(at - other) for other in truth) for at in both.onsets()]
    assert len(off) >= 5 and statistics.median(off) < 0.02, off
    sound.stop()


run({"file": file, "hang": hang, "learn": learn, "saver": saver, "server": server, "player": player})
