#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A film of two hours with a track of 20 000 cues at the desk: a table of how long things take, and what it checks on the way.

Usage: two_hours.py     Expects TRACK (tactile-track) and what it needs in the environment.
"""
import pathlib
import subprocess
import tempfile
import time

from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import HEADER, Desk, Page, changed_lines, cue, validate, wait_until

HOURS = 2
CUES = 20_000
RATE = 24
EVERY = HOURS * 3_600_000 // CUES  # ms


def make_film(path):
    subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", f"testsrc=size=160x90:rate={RATE}", "-f", "lavfi", "-i", "sine=frequency=220:sample_rate=16000",
                    "-t", str(HOURS * 3600), "-c:v", "libx264", "-preset", "ultrafast", "-g", str(2 * RATE), "-c:a", "aac", "-b:a", "32k", path], check=True)


def memory(process):
    """Resident, in MiB."""
    return int(next(line.split()[1] for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines() if line.startswith("VmRSS"))) / 1024


def main():
    rows = []

    def timed(what, act):
        begin = time.monotonic()
        act()
        rows.append((what, f"{time.monotonic() - begin:.2f} s"))

    with tempfile.TemporaryDirectory(prefix="desk-two-hours-", ignore_cleanup_errors=True) as folder, chromium() as driver:
        folder = pathlib.Path(folder)
        film, track, before = folder / "film.mp4", folder / "film.vtt", folder / "before.vtt"
        make_film(film)
        track.write_text(HEADER + "".join(cue(i * EVERY, i * EVERY + EVERY // 2, {i % 9: 30 + i % 70}) for i in range(CUES)) + cue(HOURS * 3_600_000 - 100, HOURS * 3_600_000, {}))
        before.write_bytes(track.read_bytes())
        begin = time.monotonic()
        with Desk(film) as desk:
            rows.append(("the desk is there", f"{time.monotonic() - begin:.2f} s"))
            begin = time.monotonic()
            page = Page(driver, desk)
            rows.append(("the page is there", f"{time.monotonic() - begin:.2f} s"))
            timed("to a time near the end", lambda: page.go_to(7_190_000))

            def steps():
                for _ in range(10):
                    at = page.position()
                    page.keys(".")
                    page.wait("the next frame", lambda: abs(page.position() - at - 1000 / RATE) < 1 and not page.js("return document.getElementById('video').seeking"))

            timed("ten frames on, one by one", steps)
            page.go_to(7_180_180)
            page.record()

            def edit():
                page.keys("5")
                page.wait("the edit on the disk", lambda: page.find("#save-state").get_attribute("data-state") == "journal")

            timed("an edit, until it is on the disk", edit)
            timed("a save", page.save)
            page.settled()
            timed("the whole track is undone and saved", lambda: (page.keys((Keys.CONTROL, "z")), page.wait("the undo", lambda: page.find("#save-state").get_attribute("data-state") == "journal"), page.save()))
            assert track.read_bytes() == before.read_bytes(), changed_lines(before, track)
            validate(track)
            wait_until("thumbnails", lambda: desk.get("thumbnails").json["count"] > 0)
            rows.append(("the desk's memory", f"{memory(desk.process):.0f} MiB"))
    print("| of a film of two hours with 20 000 cues | takes |\n|---|---|")
    for what, took in rows:
        print(f"| {what} | {took} |")


if __name__ == "__main__":
    main()
