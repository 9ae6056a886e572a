#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""tactile-track index and find, in a folder and on a static web server, which sees two requests and nothing of the user's.
Usage: find | play. Environment: TRACK; for play also PLAY, the desk and the plugins"""

import csv
import functools
import http.server
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading

work = pathlib.Path(tempfile.mkdtemp())
library, films = work / "library", work / "films"
library.mkdir()
films.mkdir()
requests = []


class Handler(http.server.SimpleHTTPRequestHandler):
    def do_GET(self):
        requests.append((self.path, dict(self.headers)))
        if self.path.startswith("/moved/"):
            self.send_response(302)
            self.send_header("Location", "/" + self.path.removeprefix("/moved/"))
            self.end_headers()
        else:
            super().do_GET()

    def log_message(self, *_):
        pass


def track(*arguments, status=0):
    done = subprocess.run([os.environ["TRACK"], *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == status, (arguments, done)
    return done.stdout if status == 0 else done.stderr


def expect(found, *parts):
    assert all(part in found for part in parts), (found, parts)


(library / "A film.csv").write_text("# tactile grid=1x1 rate=5\ntime_ms,t0\n0,1\n12000,0\n", encoding="utf-8")
(films / "A film.mkv").write_bytes(b"the content of a film" * 10000)
expect(track("index", library, "--films", films), "1 tracks")

server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=library))
threading.Thread(target=server.serve_forever, daemon=True).start()
address = f"http://127.0.0.1:{server.server_port}"


def find():
    # By its name, then under another name by its content.
    expect(track("find", films / "A film.mkv", "--tracks", library), str(library / "A film.csv"))
    renamed = (films / "A film.mkv").rename(films / "Renamed.mkv")
    expect(track("find", renamed, "--tracks", library), str(library / "A film.csv"))
    out = work / "out.csv"
    expect(track("find", renamed, "--tracks", address, "-o", out), f"{address}/A%20film.csv")
    assert track("diff", out, library / "A film.csv") == "", "another track"
    assert [path for path, _ in requests] == ["/tracks.json", "/A%20film.csv"], requests
    for _, headers in requests:
        assert set(headers) <= {"Host", "Accept-Encoding", "Connection"}, headers

    # Of UTF-16, as some editors save it.
    (library / "Wide.vtt").write_text("WEBVTT\n\nNOTE tactile grid=1x1\n\n00:00.000 --> 00:01.000\n50\n", encoding="utf-16")
    (films / "Wide.mkv").write_bytes(b"wide")
    track("index", library)
    track("find", films / "Wide.mkv", "--tracks", address, "-o", out, "--force")
    assert track("diff", out, library / "Wide.vtt") == "", "another track"

    # Another film has none.
    other = films / "Another.mkv"
    other.write_bytes(b"another")
    expect(track("find", other, "--tracks", library, status=1), "no track for", "tactile-track author")
    expect(track("find", other, "--tracks", address, status=1), "no track for", "tracks.json")

    # Servers that are wrong.
    expect(track("find", renamed, "--tracks", f"{address}/moved", status=1), "got status 302", "redirects are not followed")
    expect(track("find", renamed, "--tracks", f"{address}/nowhere", status=1), "got status 404")
    (library / "tracks.json").write_text('{"tracks": [{"file": "../secret.csv", "duration": 1}]}', encoding="utf-8")
    expect(track("find", renamed, "--tracks", address, status=1), "track 1: expected 'file'")
    (library / "tracks.json").write_bytes(b" " * (9 << 20))
    expect(track("find", renamed, "--tracks", address, status=1), "at most 8388608 bytes")
    server.shutdown()
    silent = socket.create_server(("127.0.0.1", 0))
    expect(track("find", renamed, "--tracks", f"http://127.0.0.1:{silent.getsockname()[1]}", status=1), "expected an answer within 20 s")


def play():
    # visuotactile-play plays it, and the desk copies it, under another name than the film's.
    played = films / "Played.mkv"
    subprocess.run(["gst-launch-1.0", "-q", "tactiletestsrc", "num-buffers=60", "!", "video/x-raw,width=320,height=240", "!", "x264enc", "!",
                    "matroskamux", "!", "filesink", f"location={played}"], check=True)
    (library / "Of it.csv").write_text("# tactile grid=1x2\ntime_ms,t0,t1\n0,0,0\n500,0,0.5\n1500,0,0\n1800,0,0\n", encoding="utf-8")
    (films / "Of it.mkv").symlink_to(played)
    expect(track("index", library, "--films", films), "2 tracks")
    (films / "Of it.mkv").unlink()
    subprocess.run([os.environ["PLAY"], "--no-window", "--driver=simulator", f"--output={work / 'out'}", f"--tracks={address}", played], check=True)
    with open(work / "out" / "commands.csv", encoding="utf-8") as file:
        commands = list(csv.DictReader(file))
    assert commands and all(each["tactor"] == "1" for each in commands), commands
    assert commands[0]["effect_ns"] == "500000000" and "1.500" in [each["volts"] for each in commands], commands
    assert commands[-1]["effect_ns"] == "1500000000" and float(commands[-1]["volts"]) == 0, commands
    with subprocess.Popen([os.environ["TRACK"], "desk", played, "--no-browser", "--driver=simulator", f"--tracks={address}"],
                          stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as desk:
        desk.stderr.readline()  # its driver
        expect(desk.stderr.readline(), "is a copy of", "Of%20it.csv")
        desk.stdout.readline()  # its address
        desk.send_signal(signal.SIGINT)
        desk.communicate()
    assert track("diff", played.with_suffix(".vtt"), library / "Of it.csv") == ""

    # Subtitles beside the film, in the folder of tracks, too: the analysis is played. Cues are played at their own times, between frames.
    for folder in films, work / "empty":
        folder.mkdir(exist_ok=True)
        (folder / "Of it.vtt").write_text("WEBVTT\n\n00:01.000 --> 00:02.000\nHello\n", encoding="utf-8")
    again = (played.with_suffix(".vtt").unlink(), played.rename(films / "Of it.mkv"))[1]

    def play_from(name, folder):
        done = subprocess.run([os.environ["PLAY"], "--no-window", "--driver=simulator", f"--output={work / name}", f"--tracks={folder}", again],
                              capture_output=True, text=True, check=True)
        with open(work / name / "commands.csv", encoding="utf-8") as file:
            return done.stderr, [(int(row["effect_ns"]) // 1000000, round(float(row["volts"]), 2)) for row in csv.DictReader(file)]

    expect(play_from("analyzed", work / "empty")[0], "Of it.vtt", "there is no track", "the analysis")
    (work / "empty" / "Of it.csv").write_text(
        "# tactile grid=1x1 rate=0\ntime_ms,t0\n0,0\n511,0.5\n583,0\n745,0.75\n749,0\n1007,1\n1800,0\n", encoding="utf-8")
    short = play_from("short", work / "empty")[1]
    # The soft start makes several of the first command.
    assert short[0][0] == 511 and short[-5:] == [(583, 0), (745, 2.25), (749, 0), (1007, 3), (1800, 0)], short


{"find": find, "play": play}[sys.argv[1]]()
