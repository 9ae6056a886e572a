#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Review: what differs from the draft is accepted, rejected and commented, and the file says so.

Usage: reviewing.py [TEST ...]
"""
import os
import subprocess

from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Desk, Page, changed_lines, desk_with, run, validate


def rows(page):
    return page.all("#review tbody tr")


def shown(page):
    """[(draft, edited)] of the rows, as a screen reader says them."""
    return [tuple(picture.get_attribute("aria-label") for picture in row.find_elements("css selector", ".map")) for row in rows(page)]


def changes_are_decided_cue_by_cue(driver):
    with desk_with(driver) as (desk, folder):
        desk.end()
        draft = folder / "draft.vtt"
        subprocess.run([os.environ["TRACK"], "author", "-q", "--rate=5", folder / "film.webm", "-o", draft], check=True, timeout=120)
        head, *cues = draft.read_text().split("\n\n00:")
        taken, louder = cues[1], cues[4]
        level = next(word for word in louder.split("\n", 1)[1].split() if word != "0")
        cues[4] = louder.replace(level, "11")
        assert cues[4] != louder
        del cues[1]
        track = folder / "film.vtt"
        track.write_text("\n\n00:".join([head, *cues]), encoding="utf-8")
        validate(track)
        before = folder / "before.vtt"
        before.write_bytes(track.read_bytes())
        with Desk(folder / "film.webm", "--review") as again:
            page = Page(driver, again)
            page.wait("the draft", lambda: len(rows(page)) == 2)
            (first, second) = shown(page)
            assert first[1] == "Edited: silent" and first[0] != "Draft: silent", first
            assert "11 %" in second[1] and f"{level} %" in second[0], second
            comment = rows(page)[1].find_element("css selector", "textarea")
            comment.send_keys("softer here" + Keys.TAB)
            page.wait("the comment", lambda: any(each[3] == ["softer here"] for each in page.track()))
            rows(page)[1].find_element("css selector", "[data-name=accept]").click()
            page.wait("one to decide", lambda: len(rows(page)) == 1)
            rows(page)[0].find_element("css selector", "[data-name=reject]").click()
            page.wait("nothing to decide", lambda: len(rows(page)) == 0)
            assert page.find("#review caption").text == "0 of 1 changes to decide"
            page.click("#review label input")
            page.wait("what is accepted", lambda: len(rows(page)) == 1)
            page.save()
            validate(track)
            removed, added = changed_lines(before, track)
            text = "\n".join(added)
            assert not removed, removed
            assert "NOTE softer here" in text and "NOTE review: accepted" in text and taken.split("\n", 1)[1].strip() in text, text
            # Everything can be undone, also what a review has done.
            for _ in range(3):
                page.keys((Keys.CONTROL, "z"))
            page.save()
            assert changed_lines(before, track) == ([], []), changed_lines(before, track)
            driver.get("about:blank")


TESTS = [changes_are_decided_cue_by_cue]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
