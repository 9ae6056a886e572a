#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A browser that is reloaded or killed in the middle, and edits that do not get through: nothing is lost.

Usage: surviving.py [TEST ...]
"""
import os
import pathlib
import signal

from chromium import chromium
from desk_page import Desk, Keys, Listener, Page, cue, desk_with, run, validate

PULSE = cue(1000, 1400, {4: 75})
END = [(19800, 20000, {}, [])]


def block(driver, *patterns):
    driver.execute_cdp_cmd("Network.enable", {})
    driver.execute_cdp_cmd("Network.setBlockedURLs", {"urls": list(patterns)})


def a_reload_keeps_what_was_edited(driver):
    with desk_with(driver, [PULSE]) as (desk, folder):
        page = Page(driver, desk)
        page.stamp(0, 5000)
        page.settled()
        page.load()
        assert page.track()[1] == (5000, 5200, {0: 75}, [])
        page.go_to(5000)
        assert "75" in page.find("#cells button").text
        page.save()
        validate(folder / "film.vtt")
        assert "00:00:05.000" in (folder / "film.vtt").read_text()


def edits_that_did_not_get_through_are_sent_later(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        block(driver, "*/edits")
        page.stamp(0, 5000)
        page.wait("an edit that is not sent", lambda: "Not sent: 1" in page.find("#save-state").text)
        page.load()  # the browser asks whether to leave, which the driver does
        assert desk.get("track").json["revision"] == 0
        block(driver)
        page.load()
        page.wait("the edit", lambda: any("restored" in text for text in page.news()))
        assert page.track()[1] == (5000, 5200, {0: 75}, [])
        page.go_to(5000)
        page.wait("it to be seen", lambda: "75" in page.find("#cells button").text)


def undo_survives_a_reload(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        before = page.track()
        page.stamp(0, 5000)
        page.stamp(1, 6000)
        page.settled()
        page.keys("j", (Keys.CONTROL, "z"))
        once = page.track()
        page.load()
        page.may_write()
        assert (page.find("#undo").get_attribute("title"), page.find("#redo").get_attribute("title")) == ("Undo: Paint", "Redo: Paint")
        page.keys((Keys.CONTROL, "z"))
        assert page.track() == before
        page.keys((Keys.CONTROL, Keys.SHIFT, "z"), (Keys.CONTROL, Keys.SHIFT, "z"))
        assert [each[0] for each in page.track()] == [1000, 5000, 6000, 19800]
        page.keys((Keys.CONTROL, "z"))
        assert page.track() == once
        # Steps for a track that has become another one are not offered.
        page.load()
        page.may_write()
        driver.get("about:blank")
        other = Listener(desk, "other", writes=False)
        assert desk.post("writer", {"page": "other", "take": True}).json == {"writer": True}
        assert other.edit(desk.get("track").json["revision"], {"at": 0, "remove": 1, "insert": []}).status == 200
        other.leave()
        page.load()
        page.may_write()
        assert not page.find("#undo").is_enabled() and not page.find("#redo").is_enabled()


def edits_are_sent_when_the_line_is_back(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        block(driver, "*/edits")
        for cell in range(3):
            page.stamp(cell, 5000 + 1000 * cell)
        page.wait("edits that are not sent", lambda: "Not sent: 3" in page.find("#save-state").text)
        block(driver)
        assert [each[0] for each in page.track()] == [1000, 5000, 6000, 7000, 19800]


def an_edit_that_does_not_fit_is_offered(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        block(driver, "*/edits")
        page.stamp(0, 5000)
        page.wait("an edit that is not sent", lambda: "Not sent: 1" in page.find("#save-state").text)
        other = Listener(desk, "other", writes=False)
        assert desk.post("writer", {"page": "other", "take": True}).json == {"writer": True}
        answer = other.edit(0, {"at": 1, "remove": 0, "insert": [{"start": 2000, "end": 2200, "levels": [1] * 9}]})
        assert answer.status == 200, answer.body
        block(driver)
        page.wait("read only", lambda: page.find("#reader").is_displayed())
        page.click("#take-over")
        page.wait("the offer", lambda: page.all("#alerts a[download]"))
        assert [each[0] for each in page.track()] == [1000, 2000, 19800]
        page.stamp(1, 7000)
        assert [each[0] for each in page.track()] == [1000, 2000, 7000, 19800]
        other.leave()


# Answers to "writer" wait until `release()`; `held` counts them.
HOLD_ANSWERS = """
    const whole = window.fetch;
    window.held = 0;
    const released = new Promise((resolve) => { window.release = resolve; });
    window.fetch = async (...all) => {
      const answer = await whole(...all);
      if (all[0] === 'writer') {
        window.held++;
        await released;
      }
      return answer;
    };"""


def the_seat_becomes_free_while_the_page_hears_a_refusal(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        other = Listener(desk, "other", writes=False)
        assert desk.post("writer", {"page": "other", "take": True}).json == {"writer": True}
        script = driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": HOLD_ANSWERS})["identifier"]
        driver.get(desk.address)
        driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", {"identifier": script})
        page.wait("a refusal on its way", lambda: page.js("return window.held") == 1)
        other.leave()
        page.wait("a free seat", lambda: "no page edits" in page.js("return document.getElementById('reader-text').textContent"))
        page.js("window.release()")
        page.stamp(0, 5000)
        assert page.track()[1] == (5000, 5200, {0: 75}, [])


def browser_of(driver):
    """The process of Chromium, a child of the driver's."""
    own = driver.service.process.pid
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == own:
            return int(stat.parent.name)
    raise AssertionError("the driver has no browser")


def a_browser_is_killed_in_the_middle(driver):
    with desk_with(driver, [PULSE]) as (desk, folder):
        with chromium() as other:
            page = Page(other, desk)
            page.stamp(0, 5000)
            page.stamp(1, 6000)
            page.settled()
            page.record()
            page.go_to(8000)
            page.keys("k")
            page.play_until(8300)
            page.down("5")
            os.kill(browser_of(other), signal.SIGKILL)
        page = Page(driver, desk)
        page.wait("to write", lambda: page.find("#save").is_enabled())
        assert [each[0] for each in page.track()] == [1000, 5000, 6000, 19800]
        page.save()
        validate(folder / "film.vtt")


def another_program_has_changed_the_file(driver):
    with desk_with(driver, [PULSE]) as (desk, folder):
        page = Page(driver, desk)
        page.stamp(0, 5000)
        page.settled()
        theirs = (folder / "film.vtt").read_text() + "\nNOTE by another program\n"
        (folder / "film.vtt").write_text(theirs)
        for _ in range(2):
            page.keys((Keys.CONTROL, "s"))
            # Each save asks anew.
            page.wait("the question", lambda: page.js("return document.querySelectorAll('#save-over:not([data-seen])').length") == 1)
            page.js("document.getElementById('save-over').dataset.seen = true")
            assert page.js("return document.querySelectorAll('#save-over').length") == 1
            assert (folder / "film.vtt").read_text() == theirs
        page.click("#save-over")
        page.wait("the save", lambda: page.find("#save-state").get_attribute("data-state") == "saved")
        assert "by another program" not in (folder / "film.vtt").read_text()
        assert (folder / "film.vtt.desk~1~").read_text() == theirs
        validate(folder / "film.vtt")


def an_open_page_goes_on_after_a_restart(driver):
    with desk_with(driver, [PULSE]) as (desk, folder):
        page = Page(driver, desk)
        page.stamp(0, 5000)
        page.save()
        page.stamp(1, 6000)
        page.settled()
        desk.end()
        page.wait("the end", lambda: any("cannot be reached" in text for text in page.errors()))
        with Desk(folder / "film.webm", "--no-browser") as again:
            assert again.address == desk.address
            page.wait("the desk", lambda: page.errors() == [])
            page.may_write()
            page.keys("j", (Keys.CONTROL, "z"), (Keys.CONTROL, "z"))
            assert [each[0] for each in page.track()] == [1000, 19800]
            page.keys((Keys.CONTROL, Keys.SHIFT, "z"))
            page.save()
            validate(folder / "film.vtt")
            assert "00:00:05.000" in (folder / "film.vtt").read_text()


def an_address_is_kept_for_the_user_alone(driver):
    kept = pathlib.Path(os.environ["XDG_STATE_HOME"]) / "visuotactile/desk"
    with desk_with(driver, [PULSE]) as (desk, folder):
        first = desk.address
        file, = [path for path in kept.iterdir() if path.read_text().strip() in first]
        assert (file.stat().st_mode & 0o777, kept.stat().st_mode & 0o777) == (0o600, 0o700)
        desk.end()
        whole = file.read_text()
        for what in ("others could read it", "cut off", "another text"):
            if what == "others could read it":
                file.chmod(0o640)
            else:
                file.write_text(whole[:20] if what == "cut off" else "../" + whole[3:])
            with Desk(folder / "film.webm", "--no-browser") as again:
                assert again.port == desk.port and again.address != first, what
                assert file.read_text().strip() in again.address and file.stat().st_mode & 0o777 == 0o600, what


TESTS = [an_open_page_goes_on_after_a_restart, an_address_is_kept_for_the_user_alone, undo_survives_a_reload, another_program_has_changed_the_file, a_reload_keeps_what_was_edited, edits_that_did_not_get_through_are_sent_later, edits_are_sent_when_the_line_is_back,
         an_edit_that_does_not_fit_is_offered, the_seat_becomes_free_while_the_page_hears_a_refusal, a_browser_is_killed_in_the_middle]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
