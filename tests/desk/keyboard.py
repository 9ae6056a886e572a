#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A film of one minute, authored, corrected and saved by keyboard alone: no click, no pointer.

Usage: keyboard.py [TEST ...]
"""
from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Page, changed_lines, cue, desk_with, run, validate

LENGTH = 60  # s
ONE_FRAME = 40  # ms


def tab_to(page, css):
    """Tab, until something that matches has the focus."""
    for _ in range(120):
        if page.js("return document.activeElement.matches(arguments[0])", css):
            return
        page.keys(Keys.TAB)
    raise AssertionError(f"Tab does not reach {css}")


def type_time(page, text):
    page.keys("t", text, Keys.ENTER)
    seconds = sum(float(part) * 60**i for i, part in enumerate(reversed(text.split(":"))))
    page.wait(f"the film at {text}", lambda: abs(page.position() - seconds * 1000) <= 1)
    page.wait("the keyboard for the timeline", lambda: page.js("return document.activeElement.matches('#timeline canvas')"))


def a_minute_is_authored_and_corrected(driver):
    with desk_with(driver, seconds=LENGTH) as (desk, folder):
        page = Page(driver, desk)
        # Recorded at twice the speed: cells 5, 1 and 9, the last two together.
        page.keys("]", "]", "r", "k")
        page.play_until(1000)
        page.down("5")
        page.play_until(2000)
        page.up("5")
        page.play_until(4000)
        page.down("1")
        page.down("9")
        page.play_until(5000)
        page.up("1")
        page.up("9")
        page.keys("k", "r", "[", "[")
        recorded = page.track()[:-1]
        cells = [set(each[2]) for each in recorded]
        assert cells[0] == {4} and recorded[0][0] >= 1000 and {4} not in cells[1:] and {0, 8} in cells[1:], recorded
        # A heartbeat for six seconds, from a template.
        type_time(page, "20")
        page.keys(Keys.HOME, Keys.ARROW_UP)
        type_time(page, "20")
        page.keys(*[Keys.ARROW_DOWN] * 4, "i")
        type_time(page, "26")
        page.keys("o", "p")
        tab_to(page, "#selection-tab")
        page.keys(Keys.ARROW_RIGHT)
        tab_to(page, "#templates select")
        page.keys("h")
        tab_to(page, "#templates button")
        page.keys(Keys.ENTER)
        beats = [each for each in page.track() if 20000 <= each[0] < 26000]
        assert len(beats) >= 12 and all(set(each[2]) <= {4} for each in beats), beats
        # Events by hand: drawn, made louder, moved, copied, split, deleted.
        type_time(page, "40")
        page.keys(Keys.ESCAPE, Keys.ENTER, "+", "+", (Keys.ALT, Keys.ARROW_RIGHT))
        here = lambda: [each for each in page.track() if 39000 <= each[0] < 59000]
        assert here() == [(40040, 40240, {4: 85}, [])], here()
        page.keys((Keys.CONTROL, "c"))
        type_time(page, "50")
        page.keys((Keys.CONTROL, "v"))
        assert here()[1:] == [(50000, 50200, {4: 85}, [])], here()
        page.keys(Keys.ESCAPE, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ENTER, Keys.DELETE)
        assert here() == [(40040, 40240, {4: 85}, [])], here()
        page.keys((Keys.CONTROL, "z"))
        assert len(here()) == 2
        # A comment.
        page.keys(Keys.ESCAPE, Keys.ENTER, "p")
        tab_to(page, "[name=comment]")
        page.keys("a door shuts")
        page.keys((Keys.SHIFT, Keys.TAB), Keys.ENTER)
        page.wait("the comment", lambda: here()[-1] == (50000, 50200, {4: 85}, ["a door shuts"]))
        page.save()
        track = folder / "film.vtt"
        validate(track)
        removed, added = changed_lines(folder / "before.vtt", track)
        assert not removed and "NOTE a door shuts" in added, (removed, added)
        # Corrected after it was saved: what is not touched stays, byte by byte.
        (folder / "first.vtt").write_bytes(track.read_bytes())
        type_time(page, "40.04")
        page.keys(Keys.ESCAPE, Keys.ENTER, "-")
        page.save()
        validate(track)
        assert changed_lines(folder / "first.vtt", track) == (["  0  85   0"], ["  0  80   0"]), changed_lines(folder / "first.vtt", track)


def every_control_is_reached_by_tab(driver):
    with desk_with(driver, [cue(1000, 1400, {4: 75})]) as (desk, _):
        page = Page(driver, desk)
        page.js("for (const details of document.querySelectorAll('details')) details.open = true")
        page.go_to(1100)
        page.keys("j", "i")
        wanted = page.js("""return [...document.querySelectorAll('button, input, select, textarea, summary, a, [tabindex]')]
            .filter((e) => e.checkVisibility() && !e.disabled && e.tabIndex >= 0 && !e.closest('dialog')).length""")
        page.js("window.reached = new Set(); document.addEventListener('focusin', ({ target }) => window.reached.add(target))")
        for _ in range(wanted + 10):
            page.keys(Keys.TAB)
        missed = page.js("""return [...document.querySelectorAll('button, input, select, textarea, summary, a, [tabindex]')]
            .filter((e) => e.checkVisibility() && !e.disabled && e.tabIndex >= 0 && !e.closest('dialog') && !window.reached.has(e)).map((e) => e.outerHTML.slice(0, 80))""")
        assert wanted > 40 and missed == [], (wanted, missed)


def help_lists_the_keys_and_switches_them_off(driver):
    with desk_with(driver) as (desk, _):
        page = Page(driver, desk)
        page.keys("?")
        assert page.find("#help").is_displayed() and len(page.all("#help tr")) > 30
        tab_to(page, "#single-keys")
        page.keys(Keys.SPACE, Keys.ESCAPE)
        assert not page.find("#help").is_displayed()
        page.keys("r")
        assert page.find("#record").get_attribute("aria-pressed") == "false"
        page.keys(Keys.F1)
        tab_to(page, "#single-keys")
        page.keys(Keys.SPACE, Keys.ESCAPE, "r")
        assert page.find("#record").get_attribute("aria-pressed") == "true"


TESTS = [a_minute_is_authored_and_corrected, every_control_is_reached_by_tab, help_lists_the_keys_and_switches_them_off]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
