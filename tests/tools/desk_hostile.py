#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Who may ask the server of tactile-track desk, and how much: other sites, other names, paths out of the page, huge bodies, slow clients, nonsense. It goes on through all of it."""

import http.client
import os
import pathlib
import random
import shutil
import socket
import subprocess
import tempfile
import time

from desk_driver import LATEST, Desk, Page, cue, make_film, splice, wait_until

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-desk-"))
film = work / "film.webm"
(work / "film.vtt").write_text("WEBVTT\n\nNOTE tactile grid=1x2\n\n00:01.000 --> 00:02.000\n 50  0\n")
page_files = work / "page"


def rss(desk):
    """KiB that were needed at most."""
    return next(int(line.split()[1]) for line in pathlib.Path(f"/proc/{desk.process.pid}/status").read_text().splitlines() if line.startswith("VmHWM"))


def test_who_may_ask(desk):
    home = f"http://127.0.0.1:{desk.port}"
    assert len(desk.path) == 34 and set(desk.path.strip("/")) <= set("0123456789abcdef"), desk.path
    assert desk.get("session").status == 200
    for headers in ({"Origin": home}, {"Origin": f"http://localhost:{desk.port}"}, {"Sec-Fetch-Site": "same-origin"}, {"Sec-Fetch-Site": "none"}):
        assert desk.get("session", headers=headers).status == 200, headers
    for headers in (
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": f"https://127.0.0.1:{desk.port}"},
        {"Origin": f"http://127.0.0.1:{desk.port}.evil.example"},
        {"Origin": "http://127.0.0.1:1"},
        {"Host": "evil.example"},
        {"Host": f"evil.example:{desk.port}"},  # a name that is bound to 127.0.0.1 later
        {"Host": "127.0.0.1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ):
        for method, path in (("GET", "session"), ("POST", "writer"), ("GET", "film")):
            answer = desk.ask(method, path, "{}" if method == "POST" else None, headers)
            assert answer.status == 403 and "error" in answer.json, (headers, answer.status, answer.body)
    # A link opens the page, but nothing else.
    link = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    assert desk.get("", headers=link).status == 200 and desk.get("session", headers=link).status == 403
    wrong = ("0" if desk.path[1] != "0" else "1") + desk.path[2:]
    for path in ("/", "/session", "/" + wrong + "session", desk.path[:-1], "//", desk.path[:-2] + "/session"):
        assert desk.get(path).status == 404, path


def test_other_users(desk):
    """Another account may have learned the token. It may take a port of the user's own connection, at another address."""
    if os.geteuid() != 0:
        print("test_other_users: skipped, since only root can be another user")
        return
    with desk.connect() as kept:
        port = kept.getsockname()[1]
        places = [(f"127.0.0.{n}", port) for n in range(2, 20)] + [("127.0.0.1", 0)]
        asks = (f"import http.client\nfor place in {places}:\n line = http.client.HTTPConnection('127.0.0.1', {desk.port}, source_address=place)\n"
                f" line.request('GET', '{desk.path}session')\n print(line.getresponse().status)")
        for user, expected in ((65534, "403"), (0, "200")):
            answer = subprocess.run(["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups", "/usr/bin/python3", "-c", asks], capture_output=True, text=True, check=True)
            assert set(answer.stdout.split()) == {expected}, (user, answer.stdout)


def test_headers(desk):
    for path in ("", "session", "film", "nothing"):
        headers = desk.get(path).headers
        policy = headers["Content-Security-Policy"]
        assert policy.startswith("default-src 'none'; script-src 'self'") and "unsafe" not in policy and "*" not in policy, policy
        assert headers["Cache-Control"] == "no-store" and headers["X-Content-Type-Options"] == "nosniff" and headers["Referrer-Policy"] == "no-referrer", headers
        assert "Access-Control-Allow-Origin" not in headers
    assert desk.get("").headers["Content-Type"].startswith("text/html")
    assert desk.get("main.js").headers["Content-Type"].startswith("text/javascript")


def test_paths(desk):
    (work / "secret.txt").write_text("secret")
    for path in ("../secret.txt", "..%2fsecret.txt", "%2e%2e/secret.txt", "./../secret.txt", "page/../../secret.txt", "/etc/passwd", "%2fetc%2fpasswd", "..\\secret.txt", ".hidden.js", "main.js%00.txt", "main.js/", "a" * 5000 + ".js", "film/../secret.txt"):
        answer = desk.get(desk.path + path)
        assert answer.status in (400, 404) and b"secret" not in answer.body and b"root:" not in answer.body, (path, answer.status)
    for method, path, allowed in (("POST", "session", "GET"), ("GET", "edits", "POST"), ("DELETE", "film", "GET, HEAD"), ("PUT", "edits", "POST"), ("OPTIONS", "edits", "POST"), ("HEAD", "edits", "POST")):
        answer = desk.ask(method, path)
        assert answer.status == 405 and answer.headers["Allow"] == allowed, (method, path, answer.status, answer.headers)


def request(desk, method, path, *headers):
    return "\r\n".join([f"{method} {desk.path}{path} HTTP/1.1", f"Host: 127.0.0.1:{desk.port}", *headers, "", ""]).encode()


def test_huge_bodies(desk):
    before = rss(desk)
    # Refused by its length, before it comes.
    for path, length in (("edits", (32 << 20) + 1), ("writer", (64 << 10) + 1), ("edits", 1 << 40)):
        with desk.connect() as line:
            line.sendall(request(desk, "POST", path, f"Content-Length: {length}"))
            assert line.recv(1000).startswith(b"HTTP/1.1 413 "), path
    # A length that is not told: refused while it comes.
    for path, most in (("edits", 32 << 20), ("writer", 64 << 10)):
        with desk.connect() as line:
            line.sendall(request(desk, "POST", path, "Transfer-Encoding: chunked"))
            sent, piece, answer = 0, b"10000\r\n" + b" " * 65536 + b"\r\n", b""
            line.settimeout(LATEST)
            try:
                while sent <= 4 * most + (1 << 24):
                    line.sendall(piece)
                    sent += 65536
            except OSError:
                pass  # it is not read any more
            assert sent <= 2 * most + (1 << 23), f"{sent} bytes were taken"
            try:
                answer = line.recv(1000)
            except ConnectionResetError:
                continue
            assert answer == b"" or answer.startswith(b"HTTP/1.1 413 "), answer
    # Without the token, nothing is kept.
    with desk.connect() as line:
        line.sendall(b"POST /x/edits HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Length: %d\r\n\r\n" % (desk.port, 1 << 30))
        try:
            for _ in range(64):
                line.sendall(b" " * (1 << 20))
        except OSError:
            pass
    assert rss(desk) - before < 150 << 10, f"{rss(desk) - before} KiB"


def test_nonsense(desk):
    noise = random.Random(29)
    for data in (b"\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01\x02\x00", b"GET " + b"a" * 100_000, request(desk, "POST", "edits", "Content-Length: -1"), request(desk, "POST", "edits", "Content-Length: 5", "Content-Length: 6") + b"{}{}{", request(desk, "GET", "film", "Range: bytes=9-1"), request(desk, "GET", "film", "Range: bytes=--"), request(desk, "GET", "film", "Range: bytes=" + "1-2," * 5000)):
        with desk.connect() as line:
            try:
                line.sendall(data)
                line.shutdown(socket.SHUT_WR)
                line.recv(65536)
            except OSError:
                pass
    for _ in range(200):
        with desk.connect() as line:
            line.sendall(bytes(noise.randrange(256) for _ in range(noise.randrange(200))))
    page = Page(desk, "noise")
    good = b'{"page": "noise", "edit": "x", "revision": 0, "splices": [{"at": 0, "remove": 0, "insert": [{"start": 0, "end": 9, "levels": [1, 2], "notes": ["a"]}]}]}'
    for body in (b"", b"[]", b"{", b"null", b'"x"', b"[" * 60_000, b"\xff\xfe", b'{"page": "' + b"x" * 65 + b'"}', b'{"page": 7}', good.replace(b'"a"', b"7"), good.replace(b"[1, 2]", b'["a", 2]'), good.replace(b": 9", b": 1e9"), good.replace(b": 9", b": 99999999999999999999"), good.replace(b'"remove": 0', b'"remove": 18446744073709551615'), good.replace(b'"a"', b'"\\u0000tactile"').replace(b'"splices"', b'"spices"')):
        for path in ("edits",) if body.startswith(b'{"page": "n') else ("edits", "operation", "writer", "save", "position", "feel"):
            answer = desk.post(path, body)
            assert answer.status in (400, 423) and "error" in answer.json, (path, body[:80], answer.status, answer.body)
    assert desk.get("track").json["revision"] == 0
    page.leave()


def test_many_connections(desk):
    lines = []
    for _ in range(100):
        try:
            lines.append(desk.connect())
        except OSError:
            break
    # They do not shut the page out. Above 64 the oldest are closed.
    assert desk.get("session").status == 200
    lines[0].settimeout(LATEST)
    try:
        assert lines[0].recv(1) == b""
    except ConnectionResetError:
        pass
    lines[-1].setblocking(False)
    try:
        raise AssertionError(f"the last one is closed: {lines[-1].recv(1)}")
    except BlockingIOError:
        pass
    for line in lines:
        line.close()
    wait_until("room for a request", lambda: answers(desk))


def answers(desk):
    try:
        return desk.get("session").status == 200
    except (OSError, http.client.HTTPException):
        return False


def main():
    page_files.mkdir()
    (page_files / "index.html").write_text("<!DOCTYPE html><title>x</title>")
    (page_files / "main.js").write_text("")
    (page_files / ".hidden.js").write_text("secret")
    (page_files / "link.js").symlink_to(work / "film.vtt")
    make_film(film)
    try:
        with Desk(film, env={"VISUOTACTILE_DESK_PAGE": str(page_files)}) as desk:
            # Slow clients first: they are ended after 30 s, while the rest goes on.
            slow = [desk.connect() for _ in range(3)]
            slow[1].sendall(b"GET / HTTP/1.1\r\nHost: ")
            slow[2].sendall(request(desk, "POST", "edits", "Content-Length: 100") + b"{")
            for test in (test_who_may_ask, test_other_users, test_headers, test_paths, test_huge_bodies, test_nonsense, test_many_connections):
                test(desk)
                print(f"{test.__name__}: passed", flush=True)
            page = Page(desk, "still")
            assert page.edit(0, splice(0, 0, cue(0, 100, 1, 2))).status == 200
            began = time.monotonic()
            for number, line in enumerate(slow):
                while time.monotonic() - began < LATEST:
                    if number == 1:
                        line.settimeout(0.5)
                        try:
                            line.sendall(b"x")  # a letter now and then does not help
                            if line.recv(1000):
                                continue
                        except socket.timeout:
                            continue
                        except OSError:
                            break
                    line.settimeout(LATEST)
                    try:
                        while line.recv(1000):
                            pass
                    except ConnectionResetError:
                        pass
                    break
                else:
                    raise AssertionError(f"slow client {number} was not ended")
                line.close()
            print("slow clients: passed")
            assert page.open and answers(desk), desk.errors.read_text()
            assert desk.end() == 0, desk.errors.read_text()
    finally:
        shutil.rmtree(work)


assert os.environ["TRACK"]
main()
