#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""tactile-track index and find, in a folder and on a static web server, which sees two requests and nothing of the user's.
Environment: TRACK"""

import functools
import http.server
import os
import pathlib
import socket
import subprocess
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
print("found")
