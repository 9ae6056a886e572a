#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""visuotactile-follow and programmed media servers: Jellyfin and Emby, which add a second to the position each second between the player's own reports,
and Plex, which keeps the position of the player's last report, each 10 s. When a motor is at its level, by the commands in the trace, against where the
programmed film is. A pause, a wrong token and a file of settings that others can read are told.

Expects FOLLOW and the plugins on GST_PLUGIN_PATH."""

import http.server
import json
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import tempfile
import threading
import time

from follow_players import LATEST, wait_until
from follow_trace import make_track, onsets, read_trace

TOKEN = "0123456789abcdef"
LATE = 0.02  # s: of a player's report
MOST = {"jellyfin": 0.12, "emby": 0.12, "plex": 0.2}  # s: media_server.h's, besides LATE, which no server can know
SETTLED = {"jellyfin": 8, "emby": 8, "plex": 11}  # s after the beginning
SECONDS = 18


class Film:
    """A film on a television, from 0:00 on at `begin` until it is paused."""

    def __init__(self):
        self.begin, self.paused = time.monotonic(), None

    def reported(self, now):
        """The player's last report, and its time: each 10 s, or at the pause."""
        if self.paused is not None and now >= self.paused + LATE:
            return self.paused - self.begin, self.paused + LATE
        last = max(0, now - LATE - self.begin) // 10 * 10
        return last, self.begin + last + LATE


film = Film()


def jellyfin(now):
    position, at = film.reported(now)
    paused = film.paused is not None and now >= film.paused + LATE
    ticks = int((position + (0 if paused else (now - at) // 1)) * 1e7)
    return [{"DeviceName": "tablet"},
            {"DeviceName": "Television", "Client": "Jellyfin Android TV", "PlayState": {"PositionTicks": ticks, "CanSeek": True, "IsPaused": paused, "IsMuted": False},
             "NowPlayingItem": {"Name": "Film", "Path": "/nowhere/film.mkv", "MediaType": "Video", "RunTimeTicks": 600000000}}]


def plex(now):
    position, _ = film.reported(now)
    paused = film.paused is not None and now >= film.paused + LATE
    return {"MediaContainer": {"size": 1, "Metadata": [
        {"type": "movie", "title": "Film", "viewOffset": int(position * 1000), "Media": [{"Part": [{"file": "/nowhere/film.mkv"}]}],
         "Player": {"title": "Television", "state": "paused" if paused else "playing"}}]}}


SERVERS = {"jellyfin": ("/Sessions", "Authorization", f'MediaBrowser Token="{TOKEN}"', jellyfin),
           "emby": ("/emby/Sessions", "X-Emby-Token", TOKEN, jellyfin),
           "plex": ("/status/sessions", "X-Plex-Token", TOKEN, plex)}


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_GET(self):
        path, header, value, sessions = SERVERS[self.server.kind]
        status = 404 if self.path != path else 401 if self.headers.get(header) != value else 200
        body = json.dumps(sessions(time.monotonic())).encode() if status == 200 else b""
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


def serve(kind):
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.kind, server.daemon_threads = kind, True
    server.handle_error = lambda *_: None  # of a follower that ends
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}" + ("/emby" if kind == "emby" else "")


folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-servers-"))
followers = {}


def follow(kind, address, token=TOKEN, name=None):
    name = name or kind
    settings = folder / f"{name}-config" / "visuotactile" / "follow.conf"
    settings.parent.mkdir(parents=True)
    settings.write_text(f"[{kind}]\nserver={address}\ntoken={token}\n", encoding="utf-8")
    settings.chmod(0o644 if name == "jellyfin" else 0o600)
    env = dict(os.environ, HOME=str(folder), XDG_CONFIG_HOME=str(folder / f"{name}-config"), XDG_CACHE_HOME=str(folder / "cache"), XDG_RUNTIME_DIR=str(folder),
               DBUS_SESSION_BUS_ADDRESS="unix:path=/nowhere")
    with open(folder / f"{name}.log", "w", encoding="utf-8") as log:
        followers[name] = subprocess.Popen([os.environ["FOLLOW"], f"--server={kind}", "--driver=simulator", "--no-drafts", f"--tracks={folder / 'tracks'}",
                                            f"--trace={folder / name}.csv"], env=env, stderr=log)


def said(name):
    return (folder / f"{name}.log").read_text(encoding="utf-8")


try:
    (folder / "tracks").mkdir()
    make_track(folder / "tracks" / "film.csv", [(second, 0.35) for second in range(1, 60)], 60)
    addresses = {kind: serve(kind) for kind in SERVERS}
    film = Film()
    for kind, address in addresses.items():
        follow(kind, address)
    follow("plex", addresses["plex"], token="wrong", name="refused")
    wait_until("the film", lambda: time.monotonic() > film.begin + SECONDS)
    film.paused = time.monotonic()
    wait_until("pulses that would be felt in the pause", lambda: time.monotonic() > film.paused + 3)
    for name, follower in followers.items():
        follower.send_signal(signal.SIGINT)
        assert follower.wait(LATEST) == 0, said(name)
        assert "CRITICAL" not in said(name), said(name)
    print("| server | pulses | p50 | most |\n|---|---|---|---|")
    for kind in SERVERS:
        assert f"{kind} at {addresses[kind]} is there" in said(kind) and "plays 'film.mkv' with" in said(kind), said(kind)
        assert ("others can read" in said(kind)) == (kind == "jellyfin"), said(kind)
        felt = [effect - film.begin for effect in onsets(read_trace(folder / f"{kind}.csv"))]
        assert all(effect < film.paused - film.begin + 1 for effect in felt), "felt in a pause"
        errors = [effect - round(effect) for effect in felt if SETTLED[kind] < effect < SECONDS - 0.5]
        assert len(errors) >= 3, f"{kind}: {len(errors)} pulses"  # a busy computer may not know the position for a while
        print(f"| {kind} | {len(errors)} | {1000 * statistics.median(errors):+.0f} ms | {1000 * max(errors, key=abs):+.0f} ms |", flush=True)
        assert max(map(abs, errors)) < MOST[kind] + LATE, f"{kind}: {errors}"
    assert "status 401" in said("refused") and "is its token valid?" in said("refused"), said("refused")
    assert said("refused").count("401") == 1, said("refused")
except BaseException:
    for name in followers:
        print(name, said(name), sep="\n")
    raise
finally:
    for follower in followers.values():
        follower.kill()
        follower.wait()
    shutil.rmtree(folder)
