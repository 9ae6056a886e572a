#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Painting, forms, undo, saving, two pages at once and the way the film is felt, in Chromium.

Usage: editing.py [TEST ...]
"""
import csv
import pathlib
import subprocess
import tempfile
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Desk, Page, changed_lines, cue, desk_with, run, validate

PULSE = cue(1000, 1400, {4: 75})
END = [(19800, 20000, {}, [])]


def stamps_are_painted_and_undone(driver):
    with desk_with(driver, [PULSE]) as (desk, folder):
        page = Page(driver, desk)
        page.stamp(0, 5000)
        page.stamp(8, 5000)
        assert page.track() == [(1000, 1400, {4: 75}, []), (5000, 5200, {0: 75, 8: 75}, []), *END], page.track()
        page.keys((Keys.CONTROL, "z"))
        assert page.track()[1] == (5000, 5200, {0: 75}, [])
        page.keys((Keys.CONTROL, "z"))
        assert page.track() == [(1000, 1400, {4: 75}, []), *END]
        page.keys((Keys.CONTROL, "y"), (Keys.CONTROL, Keys.SHIFT, "z"))
        assert page.track()[1] == (5000, 5200, {0: 75, 8: 75}, [])
        page.save()
        validate(folder / "film.vtt")
        assert changed_lines(folder / "before.vtt", folder / "film.vtt") == ([], cue(5000, 5200, {0: 75, 8: 75}).split("\n")[1:]), changed_lines(folder / "before.vtt", folder / "film.vtt")
        assert list(folder.glob("film.vtt.desk~*~"))[0].read_bytes() == (folder / "before.vtt").read_bytes()


def held_keys_are_recorded(driver):
    with desk_with(driver) as (desk, _):
        page = Page(driver, desk)
        page.record()
        page.keys("k")
        page.play_until(500)
        page.down("1")
        first = page.position()
        page.down("9")
        page.play_until(first + 600)
        page.up("1")
        page.play_until(first + 1000)
        page.up("9")
        last = page.position()
        page.keys("k")
        (begin, _, levels, _), *middle, (_, end, last_levels, _) = page.track()[:-1]
        assert 500 <= begin <= first and levels == {0: 75}, page.track()
        assert any(each[2] == {0: 75, 8: 75} for each in middle), page.track()
        assert last_levels == {8: 75} and first + 1000 <= end <= last, (page.track(), first, last)
        page.keys((Keys.CONTROL, "z"))
        assert page.track() == END, "one gesture is one step"


def a_mouse_paints(driver):
    with desk_with(driver) as (desk, _):
        page = Page(driver, desk)
        page.record()
        cell = page.find("#cells button:nth-child(5)")
        page.find("#play").click()
        page.play_until(300)
        ActionChains(driver).move_to_element(cell).click_and_hold().perform()
        held = page.position()
        page.play_until(held + 400)
        assert "held" in cell.get_attribute("class")
        ActionChains(driver).release().perform()
        page.wait("the cell to be let go", lambda: "held" not in cell.get_attribute("class"))
        released = page.position()
        page.play_until(released + 300)
        page.keys("k")
        (start, end, levels, _), _ = page.track()
        assert 300 <= start <= held and held + 400 <= end <= released and levels == {4: 75}, page.track()


def a_press_without_recording_changes_nothing(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        page.keys("5", "1")
        page.click("#cells button:nth-child(2)")
        assert page.track() == [(1000, 1400, {4: 75}, []), *END]


def transport_steps_frames_and_changes_the_rate(driver):
    with desk_with(driver) as (desk, _):
        page = Page(driver, desk)
        page.go_to(1000)
        page.keys(".", ".")
        page.wait("two frames later", lambda: page.position() == 1080)
        page.keys(",")
        page.wait("one frame back", lambda: page.position() == 1040)
        page.keys("[")
        assert page.js("return document.getElementById('video').playbackRate") == 0.75
        page.keys("a")
        page.wait("the button", lambda: page.find("#mute").get_attribute("aria-pressed") == "true")
        page.go_to(19000)
        page.keys("k")
        page.wait("the end", page.paused)
        assert page.find("#play").text == "Play"


def operations_work_on_the_track(driver):
    with desk_with(driver, [PULSE, cue(2000, 2100, {0: 40}), cue(3000, 3400, {1: 10})]) as (desk, _):
        page = Page(driver, desk)
        page.choose("operations", "prune-shorter", value=0.2)
        page.wait("short events to go", lambda: "Done" in page.find("#live").text)
        assert page.track() == [(1000, 1400, {4: 75}, []), (3000, 3400, {1: 10}, []), *END], page.track()
        page.choose("operations", "scale", value=0.5)
        page.wait("levels", lambda: page.track()[0][2] == {4: 38})
        page.choose("operations", "limit", longest=0.2, rest=0.1)
        page.wait("durations", lambda: page.track()[0][1] == 1200)
        for _ in range(3):
            page.keys((Keys.CONTROL, "z"))
        assert page.track() == [(1000, 1400, {4: 75}, []), (2000, 2100, {0: 40}, []), (3000, 3400, {1: 10}, []), *END]
        page.choose("operations", "prune-weaker", value=1000)
        assert page.find("#operations input:invalid"), "1000 % is no level"


def the_panel_changes_the_selection(driver):
    with desk_with(driver, [cue(1000, 1400, {4: 80})]) as (desk, _):
        page = Page(driver, desk)

        def fill(**values):
            page.js("for (const [name, value] of Object.entries(arguments[0])) document.forms.selection.elements[name].value = value", values)
            page.click("#selection button")

        page.go_to(1000)
        page.keys("j", *[Keys.ARROW_DOWN] * 4, Keys.ENTER)
        fill(start="2", end="0:02.800")
        assert page.track() == [(2000, 2800, {4: 80}, []), *END], page.track()
        fill(level=40)
        assert page.track()[0][2] == {4: 40}
        fill(fadeIn=200, fadeOut=100)
        steps = [(start, levels.get(4, 0)) for start, _, levels, _ in page.track()[:-1]]
        levels = [level for _, level in steps]
        top = levels.index(max(levels))
        assert max(levels) == 40 and levels[0] < 40 and levels[:top + 1] == sorted(levels[:top + 1]) and levels[-1] < 40, steps
        page.keys((Keys.CONTROL, "z"))
        assert page.track() == [(2000, 2800, {4: 40}, []), *END], "both fades are one step"
        page.go_to(2400)
        page.click("[data-edit=split]")
        assert page.track() == [(2000, 2400, {4: 40}, []), (2500, 2800, {4: 40}, []), *END], page.track()
        page.click("[data-edit=merge]")
        assert page.track() == [(2000, 2800, {4: 40}, []), *END], page.track()
        page.click("[data-edit=copy]")
        page.go_to(6000)
        page.click("[data-edit=paste]")
        assert page.track()[1] == (6000, 6800, {4: 40}, []), page.track()
        page.click("[data-edit=erase]")
        assert page.track() == [(6000, 6800, {4: 40}, []), *END], page.track()
        fill(comment="nothing is here")
        assert any("belongs to a cue" in error for error in page.errors()), page.errors()


def a_loop_goes_round(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        page.go_to(1000)
        page.keys("j", *[Keys.ARROW_DOWN] * 4, Keys.ENTER)
        page.click("#loop")
        page.record()
        page.keys("[", "[", "[", "k")  # slowly: the film goes on for some time before a busy browser goes back
        page.play_until(1200)
        page.down("1")
        page.wait("the begin again", lambda: page.position() < 1150)
        page.play_until(1200)
        page.up("1")
        page.keys("k")
        # A busy browser goes back late, but it goes back: nothing lasts to the end of the film, which is at 20 s.
        assert all(1000 <= start and end <= 2000 for start, end, levels, _ in page.track() if 0 in levels), page.track()


def a_film_that_the_browser_cannot_play_is_converted(driver):
    with desk_with(driver, [PULSE]) as (desk, folder):
        desk.end()
        film = folder / "old.avi"
        subprocess.run(["ffmpeg", "-v", "error", "-t", "6", "-i", folder / "film.webm", "-c:v", "mpeg2video", "-c:a", "mp2", film], check=True, timeout=60)
        with Desk(film, folder / "film.vtt") as other:
            page = Page(driver, other)
            assert "film.webm?from=0" in page.js("return document.getElementById('video').currentSrc")
            shown = lambda: page.js("return document.getElementById('time').value")
            page.keys("t", "3.5", Keys.ENTER, Keys.ESCAPE)
            page.wait("the stream from there", lambda: "from=3.5" in page.js("return document.getElementById('video').currentSrc") or page.position() == 3500)
            page.wait("its picture", lambda: page.js("return document.getElementById('video').readyState >= 2"))
            assert shown() == "0:03.500", shown()
            page.keys("k")
            page.wait("it to go on", lambda: shown() > "0:03.800")
            driver.get("about:blank")


def a_second_page_reads_and_takes_over(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        first = Page(driver, desk)
        window = driver.current_window_handle
        driver.switch_to.new_window("window")
        try:
            second = Page(driver, desk)
            second.wait("read only", lambda: second.find("#reader").is_displayed())
            assert not second.find("#save").is_enabled()
            second.keys("r", "1")
            other = driver.current_window_handle
            driver.switch_to.window(window)
            first.stamp(2, 5000)
            first.settled()
            driver.switch_to.window(other)
            second.go_to(5000)
            second.wait("the other page's edit", lambda: "75" in second.find("#cells button:nth-child(3)").text)
            second.click("#take-over")
            second.wait("to write", lambda: second.find("#save").is_enabled())
            second.stamp(6, 5000)
            assert second.track()[1] == (5000, 5200, {2: 75, 6: 75}, [])
            driver.switch_to.window(window)
            first.wait("read only", lambda: first.find("#reader").is_displayed())
            first.wait("the other's edit", lambda: "75" in first.find("#cells button:nth-child(7)").text)
        finally:
            driver.switch_to.window(other)
            driver.close()
            driver.switch_to.window(window)


def commands_of(trace):
    with trace.open(encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def the_chair_plays_along(driver):
    """Real time, as a chair is: the trace is written when the chair closes, so that only its order can be looked at."""
    with tempfile.TemporaryDirectory(prefix="desk-page-") as folder:
        trace = pathlib.Path(folder) / "commands.csv"
        with desk_with(driver, [cue(1000, 2500, {4: 75})], f"--trace={trace}") as (desk, _):
            page = Page(driver, desk)
            page.keys("k")
            page.play_until(1800)
            page.keys("k")
            time.sleep(1)
            page.keys("7")  # not recorded, only felt
            time.sleep(1)
            page.go_to(1500)  # the frame is felt for a moment
            time.sleep(1)
            page.keys("k")
            page.play_until(1900)
            driver.get("about:blank")  # the page is gone, in the middle of the cue
            time.sleep(1)
        with trace.open(encoding="utf-8") as lines:
            commands = [(int(row["tactor"]), float(row["volts"]) > 0) for row in csv.DictReader(line for line in lines if not line.startswith("#"))]
        turns = [each for i, each in enumerate(commands) if i == 0 or commands[i - 1] != each]
        assert turns == [(4, True), (4, False), (6, True), (6, False), (4, True), (4, False), (4, True), (4, False)], turns


def an_error_says_what_to_do(driver):
    with desk_with(driver, [PULSE]) as (desk, _):
        page = Page(driver, desk)
        page.click("#time")
        page.keys((Keys.CONTROL, "a"), "soon", Keys.TAB)
        assert page.errors() == ["A time is like 1:23.400 or 83.4; got 'soon'."], page.errors()
        page.click("#alerts button")
        assert page.errors() == []
        desk.end()
        page.wait("the loss", lambda: page.errors() and page.errors()[0].startswith("The desk cannot be reached."))


TESTS = [stamps_are_painted_and_undone, held_keys_are_recorded, a_mouse_paints, a_press_without_recording_changes_nothing,
         transport_steps_frames_and_changes_the_rate, operations_work_on_the_track,
         the_panel_changes_the_selection, a_loop_goes_round, a_film_that_the_browser_cannot_play_is_converted, a_second_page_reads_and_takes_over, the_chair_plays_along, an_error_says_what_to_do]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
