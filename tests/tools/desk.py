#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The server of tactile-track desk as a page uses it: edits, journal, saves, kills, who writes, the film, exports, the chair."""

import base64
import contextlib
import csv
import hashlib
import http.client
import json
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import time

from desk_driver import LATEST, Desk, Page, cue, make_film, os, splice, wait_until

TRACK = """WEBVTT - by hand

STYLE
::cue { color: red }

NOTE tactile grid=1x2 rate=5

NOTE the door

7
00:01.000 --> 00:02.000 align:start
 50.4 0

00:00:02.000 --> 00:00:03.000
  0  75

00:00:05.000 --> 00:00:06.000
 20  20

NOTE the end
"""
work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-desk-"))
film = work / "film.webm"
track = work / "film.vtt"


def fresh(text=TRACK):
    for old in work.glob("film*vtt*"):
        old.unlink()
    track.write_text(text)


def changed_lines(before, after):
    (work / "before").write_text(before)
    (work / "after").write_text(after)
    found = subprocess.run(["diff", work / "before", work / "after"], stdout=subprocess.PIPE, text=True, check=False).stdout
    return [line for line in found.splitlines() if line[:1] in "<>"]


def test_edits_and_saves():
    fresh()
    with Desk(film) as desk:
        session = desk.get("session").json
        assert session["track"]["grid"] == [1, 2] and session["track"]["rate"] == 5, session
        assert session["film"]["duration"] in range(7900, 8100) and session["film"]["frameDuration"] == 40 and session["film"]["sound"], session
        assert session["film"]["type"] == 'video/webm; codecs="vp8, opus"', session
        assert desk.get("track").json == {"revision": 0, "saved": 0, "cues": [cue(1000, 2000, 50, 0, notes=["the door"]), cue(2000, 3000, 0, 75), cue(5000, 6000, 20, 20)]}
        page = Page(desk, "one")
        assert page.edit(0, splice(1, 1, cue(2000, 3000, 0, 80))).json == {"revision": 1, "saved": 0}
        assert page.last("revision") is not None
        # What is refused changes nothing, and says what is wrong.
        for status, splices, words in (
            (400, [splice(0, 0, cue(500, 1500, 1, 1))], "overlap"),
            (400, [splice(0, 1), splice(9, 0)], "within"),
            (400, [splice(0, 1, cue(3, 3, 1, 1))], "start < end"),
            (400, [splice(0, 1, cue(0, 3, 1))], "2 levels"),
            (400, [splice(0, 1, cue(0, 3, 1, 101))], "0 to 100"),
            (400, [splice(0, 1, cue(0, 3, 1, 1, notes=["a\n\nb"]))], "notes"),
            (400, [splice(0, 1, cue(0, 3, 1, 1, notes=["tactile grid=9x9"]))], "notes"),
            (400, [{"at": -1, "remove": 0, "insert": []}], "splices"),
        ):
            answer = page.edit(1, *splices)
            assert answer.status == status and words in answer.json["error"], (answer.status, answer.body)
        stale = page.edit(0, splice(0, 1))
        assert stale.status == 409 and stale.json["revision"] == 1, stale.body
        # An answer that was lost: the same edit again.
        assert page.edit(1, splice(2, 1), name="again").json["revision"] == 2
        assert page.edit(1, splice(2, 1), name="again").json["revision"] == 2
        assert len(desk.get("track").json["cues"]) == 2
        assert page.edit(2, splice(2, 0, cue(5000, 6000, 20, 20))).json["revision"] == 3
        saved = page.save().json
        assert saved["saved"] == 3 and saved["kept"] == "film.vtt.desk~1~" and saved["path"] == str(track), saved
        # The one level; neither the comments, the identifier nor how the others are written.
        assert changed_lines(TRACK, track.read_text()) == ["<   0  75", ">   0  80"]
        assert (work / "film.vtt.desk~1~").read_text() == TRACK
        assert page.edit(3, splice(1, 1, cue(2000, 3000, 0, 75, notes=["better", "two\nlines"]))).status == 200
        page.save()
        assert changed_lines(TRACK, track.read_text()) == ["> NOTE better", "> ", "> NOTE", "> two", "> lines", "> "]
        assert desk.get("track").json["cues"][1]["notes"] == ["better", "two\nlines"]
        assert page.edit(4, splice(0, 3)).status == 200
        assert page.edit(5, splice(0, 0, cue(0, 100, 1, 2))).status == 200
    assert (work / "film.vtt.journal").exists(), "edits that were not saved"
    subprocess.run([os.environ["TRACK"], "validate", "-q", track], check=True)


def test_versions():
    fresh()
    with Desk(film) as desk:
        page = Page(desk, "one")
        for revision in range(24):
            assert page.edit(revision, splice(1, 1, cue(2000, 3000, 0, revision))).status == 200
            assert page.save().status == 200
        assert "kept" not in page.save().json
    kept = {int(re.search("~([0-9]+)~", path.name)[1]) for path in work.glob("film.vtt.desk~*~")}
    assert kept == set(range(5, 25)), kept
    assert "  0  22" in (work / "film.vtt.desk~24~").read_text() and "  0  23" in track.read_text()
    assert not (work / "film.vtt.journal").exists(), "nothing is left to save"


def test_killed_in_the_middle():
    fresh()
    answered = 0  # so many edits
    for turn in range(3):
        with Desk(film) as desk:
            assert desk.get("track").json["revision"] == answered
            if turn:
                assert str(answered) + " edit" in desk.get("session").json["messages"][0]
            page = Page(desk, f"page{turn}")
            stop = threading.Timer(0.05 * (turn + 1), desk.process.kill)
            stop.start()
            with contextlib.suppress(OSError, http.client.HTTPException):
                while True:
                    done = page.edit(answered, splice(3, 1 if answered else 0, cue(7000, 7001 + answered, 1, 2)))
                    assert done.status == 200, done.body
                    answered += 1
            assert desk.process.wait() == -signal.SIGKILL
        # The last one may be on the disk without its answer.
        with Desk(film) as desk:
            found = desk.get("track").json
            assert found["revision"] in (answered, answered + 1), (found["revision"], answered)
            answered = found["revision"]
            assert found["cues"][3] == cue(7000, 7000 + answered, 1, 2)
    assert track.read_text() == TRACK
    # An edit that was cut off while it was written was never answered.
    with (work / "film.vtt.journal").open("ab") as journal:
        journal.write(b'{"page": "x", "edit": "half", "rev')
    with Desk(film) as desk:
        page = Page(desk, "last")
        assert page.edit(answered, splice(3, 1)).status == 200
        page.save()
        assert track.read_text() == TRACK
    # A line that makes no sense: what comes after it is kept in a file.
    with Desk(film) as desk:
        assert Page(desk, "one").edit(0, splice(0, 1)).status == 200
    with (work / "film.vtt.journal").open("ab") as journal:
        journal.write(b"nonsense\n")
    with Desk(film) as desk:
        assert desk.get("track").json["revision"] == 1 and "damaged" in "".join(desk.get("session").json["messages"])
    assert b"nonsense" in (work / "film.vtt.journal.damaged-1").read_bytes()


def test_another_program():
    fresh()
    with Desk(film) as desk:
        assert Page(desk, "one").edit(0, splice(1, 1, cue(2000, 3000, 0, 99))).status == 200
        try:
            Desk(film)
            raise AssertionError("two desks edit a track")
        except RuntimeError as error:
            assert "in use" in str(error), error
    track.write_text(TRACK.replace("20  20", "30  30"))
    with Desk(film) as desk:
        assert desk.get("track").json["cues"][2]["levels"] == [30, 30]
        assert "film.recovered.vtt" in desk.get("session").json["messages"][0]
        # Changed while the desk is open: it is replaced only if the page says so, and what it was is kept.
        track.write_text(TRACK.replace("20  20", "40  40"))
        page = Page(desk, "one")
        assert page.edit(0, splice(2, 1)).status == 200
        refused = page.save()
        assert refused.status == 409 and refused.json["changed"] and refused.json["revision"] == 1 and "another program" in refused.json["error"], refused.body
        stale = page.edit(0, splice(0, 1))
        assert stale.status == 409 and "changed" not in stale.json, stale.body
        assert "40  40" in track.read_text()
        kept = page.save(over=True).json["kept"]
    assert "40  40" not in track.read_text()
    assert "40  40" in (work / kept).read_text()
    assert changed_lines(TRACK, (work / "film.recovered.vtt").read_text()) == ["<   0  75", ">   0  99"]


def test_full_disk():
    fresh()
    with Desk(film) as desk:
        page = Page(desk, "one")
        assert page.edit(0, splice(0, 0, cue(0, 100, 1, 2))).status == 200
        journal = (work / "film.vtt.journal").stat().st_size
        resource.prlimit(desk.process.pid, resource.RLIMIT_FSIZE, (journal + 20, resource.RLIM_INFINITY))
        answer = page.edit(1, splice(1, 1))
        assert answer.status == 507 and "film.vtt.journal" in answer.json["error"], answer.body
        assert (work / "film.vtt.journal").stat().st_size == journal
        assert len(desk.get("track").json["cues"]) == 4
        resource.prlimit(desk.process.pid, resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
        answer = page.save()
        assert answer.status == 507 and track.read_text() == TRACK, answer.body
        resource.prlimit(desk.process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        assert page.edit(1, splice(1, 1)).json["revision"] == 2
        assert page.save().status == 200
        assert not list(work.glob(".film*")), "a part of a file is left"
    assert len(changed_lines(TRACK, track.read_text())) > 3


def test_who_writes():
    fresh()
    with Desk(film) as desk:
        assert desk.post("writer", {"page": "deaf"}).json == {"writer": False}, "it does not listen"
        first, second = Page(desk, "first"), Page(desk, "second", writes=False)
        assert desk.post("writer", {"page": "second"}).json == {"writer": False}
        refused = second.edit(0, splice(0, 1))
        assert refused.status == 423 and refused.json["writer"] == "first", refused.body
        assert second.save().status == desk.post("feel", {"page": "second", "levels": [1, 1], "duration": 50}).status == 423
        assert desk.post("writer", {"page": "second", "take": True}).json == {"writer": True}
        wait_until("the first to hear it", lambda: first.last("writer") == {"writer": "second"})
        assert first.edit(0, splice(0, 1)).status == 423
        assert second.edit(0, splice(0, 1)).status == 200
        wait_until("the first to hear of the edit", lambda: first.last("revision") == {"revision": 1, "saved": 0})
        second.leave()  # as a browser that is killed
        wait_until("the seat to be free", lambda: first.last("writer") == {"writer": None})
        assert desk.post("writer", {"page": "first"}).json == {"writer": True}
        assert desk.post("writer", {"page": "first", "give": True}).json == {"writer": False}


def test_film_and_strip():
    fresh()
    data = film.read_bytes()
    with Desk(film) as desk:
        whole = desk.get("film")
        assert whole.body == data and whole.headers["Content-Type"] == "video/webm" and whole.headers["Accept-Ranges"] == "bytes", whole.headers
        size = len(data)
        for asked, first, last in (("0-", 0, size), ("10-19", 10, 20), (f"{size - 1}-", size - 1, size), ("-7", size - 7, size), (f"5-{size + 9}", 5, size)):
            part = desk.get("film", headers={"Range": "bytes=" + asked})
            assert part.status == 206 and part.body == data[first:last], (asked, part.status, len(part.body))
            assert part.headers["Content-Range"] == f"bytes {first}-{last - 1}/{size}", part.headers
        past = desk.get("film", headers={"Range": f"bytes={size}-"})
        assert past.status == 416 and past.headers["Content-Range"] == f"bytes */{size}", past.headers
        for asked in ("bytes=0-1,5-6", "lines=1-2"):  # a server may answer with all
            assert desk.get("film", headers={"Range": asked}).body == data, asked
        head = desk.ask("HEAD", "film")
        assert head.body == b"" and head.headers["Content-Length"] == str(size), head.headers
        # A client that takes a little and leaves.
        with desk.connect() as line:
            line.sendall(f"GET {desk.path}film HTTP/1.1\r\nHost: 127.0.0.1:{desk.port}\r\n\r\n".encode())
            line.recv(100)

        page = Page(desk, "p", writes=False)
        wait_until("the strip", lambda: page.last("progress")["strip"] == 1)
        # The film is cut at 4 s.
        assert desk.get("cuts").json["cuts"] == [4000], desk.get("cuts").body
        pictures = desk.get("thumbnails").json
        assert pictures["count"] == 8 and (pictures["width"], pictures["height"]) == (160, 90) and pictures["interval"] == 1000, pictures
        assert desk.get("thumbnail?index=7").body.startswith(b"\xff\xd8") and desk.get("thumbnail?index=7").headers["Content-Type"] == "image/jpeg"
        for wrong in ("8", "-1", "x", ""):
            assert desk.get("thumbnail?index=" + wrong).status == 404
        # A tick each second.
        sound = desk.get("sound").body
        loud = [i for i, peak in enumerate(sound) if peak > 50]
        assert {round(i / 100) for i in loud} - {8} == set(range(8)) and len(loud) < 40, loud
        assert desk.get("sound?from=300").body == sound[300:] and desk.get("sound?from=-1").status == 400
        # As a browser that cannot play it: from 3 s on there are 125 frames.
        proxy = work / "proxy.webm"
        proxy.write_bytes(desk.get("film.webm?from=3").body)
        frames = subprocess.run(["ffprobe", "-v", "error", "-count_packets", "-select_streams", "v", "-show_entries", "stream=codec_name,nb_read_packets", "-of", "csv=p=0", proxy], stdout=subprocess.PIPE, text=True, check=True).stdout
        assert frames.strip() == "vp8,125", frames
        assert desk.get("film.webm?from=-1").status == desk.get("film.webm?from=nan").status == 400
        # Three at a time: the first is ended.
        lines = []
        for _ in range(3):
            lines.append(desk.connect())
            lines[-1].sendall(f"GET {desk.path}film.webm HTTP/1.1\r\nHost: 127.0.0.1:{desk.port}\r\n\r\n".encode())
            assert lines[-1].recv(1000)
        while lines[0].recv(1 << 20):
            pass
        for line in lines:
            line.close()


def test_clocked_film():
    """A transport stream counts from a clock: pictures, sound and film are those of its 0:00."""
    clocked = work / "clocked.ts"
    subprocess.run(["ffmpeg", "-v", "error", "-i", film, "-c:v", "mpeg2video", "-bf", "2", "-c:a", "mp2", clocked], check=True)
    told = json.loads(subprocess.check_output(["ffprobe", "-v", "error", "-show_entries", "format=start_time:stream=start_time", "-select_streams", "v", "-of", "json", clocked]))
    first = float(told["streams"][0]["start_time"]) - float(told["format"]["start_time"])
    (work / "clocked.vtt").write_text(TRACK)
    with Desk(clocked) as desk:
        page = Page(desk, "p", writes=False)
        wait_until("the strip", lambda: page.last("progress")["strip"] == 1)
        cuts = desk.get("cuts").json["cuts"]
        assert len(cuts) == 1 and abs(cuts[0] - 4000 - 1000 * first) <= 1, (cuts, first)
        loud = [i for i, peak in enumerate(desk.get("sound").body) if peak > 50]
        assert {round(i / 100) for i in loud} - {8} == set(range(8)), loud
        proxy = work / "clocked.webm"
        proxy.write_bytes(desk.get("film.webm?from=3").body)
        frames = subprocess.run(["ffprobe", "-v", "error", "-count_packets", "-select_streams", "v", "-show_entries", "stream=nb_read_packets", "-of", "csv=p=0", proxy], stdout=subprocess.PIPE, text=True, check=True).stdout
        assert abs(int(frames) - 125 - 25 * first) <= 1, frames


def test_operations():
    fresh(TRACK.replace("50.4", "50"))
    with Desk(film) as desk:
        page = Page(desk, "one")

        def ask(name, value=None, **selection):
            return desk.post("operation", {"revision": desk.get("track").json["revision"], "operation": name, "value": value, "selection": selection})

        # By hand: 1000–2000 [50, 0], 2000–3000 [0, 75], 5000–6000 [20, 20].
        assert ask("scale", 0.5).json["splices"] == [splice(0, 3, cue(1000, 2000, 25, 0, notes=["the door"]), cue(2000, 3000, 0, 38), cue(5000, 6000, 10, 10))]
        assert ask("scale", 0.5, cells=[1], to=3000).json["splices"] == [splice(1, 1, cue(2000, 3000, 0, 38))]
        assert ask("silence", **{"from": 1500, "to": 2500}).json["splices"] == [splice(0, 2, cue(1000, 1500, 50, 0, notes=["the door"]), cue(2500, 3000, 0, 75))]
        assert ask("prune-weaker", 30).json["splices"] == [splice(2, 1, cue(5000, 6000, 0, 0))], "the last one gives the length"
        assert ask("shift", 1.5, **{"from": 1000, "to": 2000}).json["splices"] == [splice(0, 2, cue(1000, 2000, 0, 0, notes=["the door"]), cue(2000, 2500, 0, 75), cue(2500, 3000, 50, 0), cue(3000, 3500, 50, 0))], "what is selected replaces what is there; the comment stays"
        assert ask("limit", [0.4, 0.1], cells=[0], to=2000).json["splices"][0]["insert"][0] == cue(1000, 1400, 50, 0, notes=["the door"])
        assert ask("prune-shorter", 0.5).json["splices"] == []
        for name, value, words in (("scale", 101, "value"), ("scale", "x", "number"), ("fly", 1, "prune-shorter"), ("limit", [1], "number")):
            answer = ask(name, value)
            assert answer.status == 400 and words in answer.json["error"], answer.body
        assert desk.post("operation", {"revision": 5, "operation": "silence"}).status == 409
        splices = ask("quantize", 4).json["splices"]
        assert page.edit(0, *splices).status == 200
        page.save()
        shutil.copy(work / "film.vtt.desk~1~", work / "before.vtt")
        subprocess.run([os.environ["TRACK"], "edit", "-q", work / "before.vtt", "-o", work / "other.vtt", "--quantize=4"], check=True)
        assert subprocess.run([os.environ["TRACK"], "diff", track, work / "other.vtt"], check=False).returncode == 0
        wait_until("the draft", lambda: page.last("progress")["draft"] == 1)
        draft = desk.get("draft").json["cues"]
        assert draft and ask("draft").json["splices"]


def test_exports():
    fresh()
    with Desk(film) as desk:
        page = Page(desk, "one")
        assert page.edit(0, splice(0, 1, cue(1000, 2000, 50, 0, notes=["</script><b>"]))).status == 200
        for form in ("vtt", "csv", "hjif", "sem.xml", "haptic", "ahap", "funscript"):
            answer = desk.get("export?format=" + form)
            assert answer.status == 200 and f"film.{form}" in answer.headers["Content-Disposition"], answer.headers
            exported = work / ("exported." + form)
            exported.write_bytes(answer.body)
            subprocess.run([os.environ["TRACK"], "validate", "-q", exported], check=True)
        assert "NOTE </script><b>" in (work / "exported.vtt").read_text()
        assert desk.get("export?format=exe").status == 400
        html = desk.get("export.html").body.decode()
        hashes, style, text, script = re.fullmatch(r"(.*)<style>(.*)</style><script type=.application/json.>(.*)</script><script>(.*)</script>", html, re.S).groups()
        assert (style, script) == ("p {}\n", "function part() {}\npart();\n"), html
        assert hashes.split() == [f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" for text in (script, style)]
        assert "</script>" not in text, text
        data = json.loads(text)
        assert data["film"] == {"name": "film.webm", "href": "film.webm"} and data["track"]["cues"][0]["notes"] == ["</script><b>"], data


def test_chair():
    """The film is felt from 0.5 s to 1 s, from 1.5 s to 2 s and so on; the trace has the clock of time.monotonic()."""
    cues = "".join(f"\n00:0{second}.500 --> 00:0{second + 1}.000\n 50 0\n" for second in range(7))
    fresh("WEBVTT\n\nNOTE tactile grid=1x2\n" + cues)
    trace = work / "trace.csv"
    silent = []  # (from, to): nothing is felt
    with Desk(film, f"--trace={trace}") as desk:
        page = Page(desk, "one")
        assert page.last("chair")["state"] == "closed"
        assert desk.post("feel", {"page": "one", "levels": [0, 60], "duration": 100}).status == 204
        pulse = time.monotonic()
        wait_until("the chair to be open", lambda: page.last("chair")["state"] == "open")

        def play(seconds, paused=False):
            began = now = time.monotonic()
            while now - began < seconds:
                told = {"page": "one", "position": (now - began) * 1000, "rate": 1, "leap": now == began}
                assert desk.post("position", told).status == 204
                time.sleep(0.1)
                now = time.monotonic()
            if paused:
                assert desk.post("position", told | {"paused": True}).status == 204
            return began

        time.sleep(1)
        plays = [play(2.8, paused=True)]
        silent.append((time.monotonic() + 0.3, time.monotonic() + 1.5))
        time.sleep(1.5)
        plays.append(play(1.8))
        # No position any more: the browser hangs.
        silent.append((time.monotonic() + 1.5, time.monotonic() + 3))
        time.sleep(3)
        plays.append(play(0.9))
        # A map that is still felt gives way to the film.
        time.sleep(1.5)
        assert desk.post("feel", {"page": "one", "levels": [0, 60], "duration": 2000}).status == 204
        plays.append(play(0.9))
        page.leave()
        silent.append((time.monotonic() + 2.5, time.monotonic() + 3.5))
        time.sleep(3.5)
        assert desk.post("feel", {"page": "one", "levels": [0, 60], "duration": 100}).status == 423
        for wrong in ({"levels": [0], "duration": 100}, {"levels": [0, 101], "duration": 100}, {"levels": [0, 1], "duration": 5000}):
            assert desk.post("feel", {"page": "one"} | wrong).status == 400
        assert desk.end(signal.SIGTERM) == 0
    lines = [line for line in trace.read_text().splitlines() if not line.startswith("#")]
    told = [(int(row["effect_ns"]) / 1e9, row["tactor"], float(row["volts"])) for row in csv.DictReader(lines)]
    ups = [(when, tactor) for when, tactor, volts in told if volts > 0]
    one_map = [when - pulse for when, tactor in ups if tactor == "1" and when < plays[0]]
    assert one_map and 0 < min(one_map) and max(one_map) < 1, one_map
    assert any(tactor == "1" and volts == 0 and when - pulse < 1.5 for when, tactor, volts in told), told
    for began in plays:
        begins = [when - began for when, tactor in ups if tactor == "0" and 0 < when - began < 1]
        assert begins and 0.3 < min(begins) < 0.8, (begins, told)
    on = {}
    for when, tactor, volts in told:
        for first, last in silent:
            assert not first < when < last or volts == 0, (when, first, last, told)
        on[tactor] = volts
    for first, _ in silent:
        levels = {tactor: volts for when, tactor, volts in told if when < first}
        assert not any(levels.values()), (first, told)
    assert not any(on.values()), told


def test_screen_saver():
    """Nothing is felt while nobody can be in the chair. The screen saver is this test."""
    fresh("WEBVTT\n\nNOTE tactile grid=1x2\n\n00:00.000 --> 00:07.000\n 50 50\n")
    trace = work / "rests.csv"
    bus = subprocess.Popen(["dbus-daemon", "--session", "--nofork", "--print-address"], stdout=subprocess.PIPE, text=True)
    try:
        address = bus.stdout.readline().strip()

        def saver(is_on):
            subprocess.run(["gdbus", "emit", "--session", "--object-path=/org/freedesktop/ScreenSaver", "--signal=org.freedesktop.ScreenSaver.ActiveChanged", is_on],
                           env={**os.environ, "DBUS_SESSION_BUS_ADDRESS": address}, check=True)

        with Desk(film, f"--trace={trace}", env={"DBUS_SESSION_BUS_ADDRESS": address}) as desk:
            page = Page(desk, "one")
            began = time.monotonic()

            def plays(what, state, seconds=0):
                begin = time.monotonic()

                def told():
                    at = (time.monotonic() - began) * 1000
                    assert desk.post("position", {"page": "one", "position": at % 6000, "rate": 1}).status == 204
                    time.sleep(0.05)  # as a page does
                    return page.last("chair")["state"] == state and time.monotonic() > begin + seconds
                wait_until(what, told)

            plays("the chair", "open", 1.5)
            saver("true")
            plays("rest", "closed")
            assert "the screen saver is on" in page.last("chair")["text"], page.last("chair")
            told = [(row["tactor"], float(row["volts"])) for row in csv.DictReader(line for line in trace.open() if not line.startswith("#"))]
            assert {tactor for tactor, volts in told if volts > 0} == {"0", "1"} and not any(dict(told).values()), told
            plays("rest", "closed", 0.5)
            assert desk.post("feel", {"page": "one", "levels": [0, 60], "duration": 100}).status == 204
            assert page.last("chair")["state"] == "closed"
            saver("false")
            plays("the chair again", "open")
            assert desk.end(signal.SIGTERM) == 0, desk.errors.read_text()
    finally:
        bus.terminate()
        bus.wait()
        bus.stdout.close()


def test_film_is_gone():
    """What is made of the film fails, and the desk goes on."""
    fresh()
    shutil.copy(film, work / "moved.webm")
    shutil.copy(track, work / "moved.vtt")
    with Desk(work / "moved.webm") as desk:
        page = Page(desk, "one")
        (work / "moved.webm").unlink()
        for _ in range(5):
            answer = desk.get("film.webm")
            assert answer.status == 500 and "cannot be converted" in answer.json["error"], (answer.status, answer.body)
        assert desk.get("film").status == 404
        assert page.edit(0, splice(1, 1)).status == 200 and page.save().status == 200
        assert desk.end(signal.SIGTERM) == 0, desk.errors.read_text()


def test_draft_is_kept():
    """Bounded and for the user alone; one that is damaged is made again, one that is gone is still in memory."""
    fresh()
    env = {"XDG_CACHE_HOME": str(work / "cache")}
    for _ in range(2):
        with Desk(film, env=env) as desk:
            page = Page(desk, "one")
            wait_until("the draft", lambda: page.last("progress")["draft"] == 1)
            kept, = (work / "cache/visuotactile/drafts").iterdir()
            assert (kept.stat().st_mode & 0o777, kept.parent.stat().st_mode & 0o777) == (0o600, 0o700), kept.stat()
            cues = desk.get("draft").json["cues"]
            kept.unlink()
            assert cues and desk.get("draft").json["cues"] == cues
        kept.write_text("WEBVTT\n\nno cue\n")


def test_one_decoding():
    """Pictures, sound and draft are made in one pass, beside the look at what the film has; the draft is what author makes."""
    fresh()
    expected = work / "authored.vtt"
    subprocess.run([os.environ["TRACK"], "author", "-q", "--rows=1", "--columns=2", "--rate=5", film, "-o", expected], check=True, timeout=LATEST)
    cues = lambda path: [line for line in path.read_text().splitlines() if not line.startswith("NOTE")]

    def decoders(begin, cache):
        """Made by the desk and by all that it runs."""
        begin()
        logs = work / "logs"
        shutil.rmtree(logs, ignore_errors=True)
        logs.mkdir()
        env = {"XDG_CACHE_HOME": str(cache), "GST_DEBUG": "GST_ELEMENT_FACTORY:4", "GST_DEBUG_FILE": str(logs / "%p.log")}
        with Desk(film, env=env) as desk:
            page = Page(desk, "p", writes=False)
            wait_until("all of it", lambda: page.last("progress") == {"draft": 1, "strip": 1})
        return sum(log.read_text().count('creating element "vp8dec"') for log in logs.iterdir())

    cache = work / "one"
    assert decoders(fresh, cache) == 2
    draft, = (cache / "visuotactile/drafts").iterdir()
    assert cues(draft) == cues(expected)
    assert decoders(fresh, cache) == 1
    # A draft for another grid; pictures and sound are there.
    assert decoders(lambda: fresh("WEBVTT\n\nNOTE tactile grid=2x2 rate=5\n\n00:01.000 --> 00:02.000\n0 0\n0 9\n"), cache) == 2
    # A draft that becomes the track.
    assert decoders(lambda: (fresh(), track.unlink()), work / "two") == 2
    assert track.exists()


def test_strip_is_kept():
    """For the user alone, and used the next time; one that is damaged, or of another film, is made again."""
    fresh()
    env = {"XDG_CACHE_HOME": str(work / "strips")}
    folder = work / "strips/visuotactile/strips"

    def all_of(desk):
        page = Page(desk, "one", writes=False)
        wait_until("the strip", lambda: page.last("progress")["strip"] == 1)
        return [desk.get(f"thumbnail?index={i}").body for i in range(desk.get("thumbnails").json["count"])], desk.get("sound").body, desk.get("cuts").json

    with Desk(film, env=env) as desk:
        first = all_of(desk)
    kept, = folder.iterdir()
    assert (kept.stat().st_mode & 0o777, folder.stat().st_mode & 0o777) == (0o600, 0o700), kept.stat()
    whole = kept.read_bytes()
    marked = b"\xff\xd8" + b"m" * (len(first[0][7]) - 2)
    kept.write_bytes(whole.replace(first[0][7], marked))
    with Desk(film, env=env) as desk:
        again = all_of(desk)
    assert again[0][7] == marked and (again[0][:7], *again[1:]) == (first[0][:7], *first[1:])
    for damaged in (b"", whole[:1000], whole[1:], b"x" * len(whole)):
        kept.write_bytes(damaged)
        with Desk(film, env=env) as desk:
            assert all_of(desk) == first, damaged[:8]
        assert kept.read_bytes() == whole
    other = work / "other.webm"
    other.write_bytes(film.read_bytes() + b"\xec\x81\x00")  # an empty element of EBML: another file with the same pictures
    shutil.copy(track, work / "other.vtt")
    with Desk(other, env=env) as desk:
        assert all_of(desk) == first
    assert len(list(folder.iterdir())) == 2


def test_start():
    fresh()
    track.unlink()
    with Desk(film) as desk:  # a draft is authored
        cues = desk.get("track").json["cues"]
        assert cues and track.exists()
        assert "authored" in desk.errors.read_text()
    # Subtitles of the same name are left alone.
    track.write_text("WEBVTT\n\n00:01.000 --> 00:02.000\nHello\n")
    with Desk(film) as desk:
        assert desk.get("session").json["track"]["name"] == "film.tactile.vtt"
    assert "Hello" in track.read_text()
    # Two tracks: the one that visuotactile-follow takes.
    track.write_text(TRACK)
    with Desk(film) as desk:
        assert desk.get("session").json["track"]["name"] == "film.tactile.vtt"
    # A track that is damaged is no film's subtitles.
    (work / "film.tactile.vtt").write_text(TRACK.replace("  0  75", "  0 175"))
    for words, told in (([film], "film.tactile.vtt': line 15"), ([work / "none.webm"], "no file"), ([film, work / "exported.csv"], "WebVTT"), ([film, "--driver=none"], "--driver is one of"), ([film, "--port=99999"], "--port")):
        try:
            Desk(*words)
            raise AssertionError(f"{words} should fail")
        except RuntimeError as error:
            assert told in str(error), error


def main():
    page = work / "page"
    page.mkdir()
    (page / "index.html").write_text("<!DOCTYPE html><title>x</title>")
    (page / "film_page.html").write_text('@SCRIPT_HASH@ @STYLE_HASH@<style>@STYLE@</style><script type="application/json">@DATA@</script><script>@SCRIPT@</script>')
    (page / "film_page.css").write_text("p {}\n")
    (page / "film_page.js").write_text("import { part } from './part.js';\npart();\n")
    (page / "part.js").write_text("export function part() {}\n")
    os.environ["VISUOTACTILE_DESK_PAGE"] = str(page)
    os.environ["XDG_CACHE_HOME"] = str(work / "usual cache")
    make_film(film)
    try:
        for name, test in list(globals().items()):
            if name.startswith("test_") and (not os.sys.argv[1:] or name in os.sys.argv[1:]):
                test()
                print(f"{name}: passed", flush=True)
    finally:
        shutil.rmtree(work)


main()
