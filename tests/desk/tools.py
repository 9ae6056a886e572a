#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Points of curves by keys, edges that snap to impacts and shot cuts, high rows, and what is red.

Usage: tools.py [TEST ...]
"""
import math
import random
import struct
import subprocess
import wave

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Desk, HEADER, Listener, Page, cue, desk_with, run

RAMP = [cue(1000 + 40 * i, 1040 + 40 * i, {4: level}) for i, level in enumerate([20] * 10 + list(range(22, 82, 4)) + [80] * 10)]
CTRL_RIGHT, CTRL_LEFT = (Keys.CONTROL, Keys.ARROW_RIGHT), (Keys.CONTROL, Keys.ARROW_LEFT)
BLOWS = [1500, 3200, 6100]  # ms


def levels(page):
    """Of cell 5, one a frame of 40 ms from 1 s on."""
    cues = page.track()
    return [next((each[2].get(4, 0) for each in cues if each[0] <= ms < each[1]), 0) for ms in range(1020, 2400, 40)]


def said(page):
    return page.js("return document.querySelector('#timeline [role=status]').textContent").strip("\u00a0")


def points_by_keys(driver):
    with desk_with(driver, RAMP) as (desk, _):
        page = Page(driver, desk)
        before = levels(page)
        page.keys("j", *[Keys.ARROW_DOWN] * 4, "h", CTRL_RIGHT)
        assert said(page).startswith("Point 1 of 4, 0:01.000, level 20") and page.position() == 1000, said(page)
        page.keys(CTRL_RIGHT)
        number, ms = said(page).split(",")[0], page.position()
        assert number == "Point 2 of 4" and abs(ms - 1400) <= 40, said(page)
        # Five times 1 %, then 5 % more, in steps of undo by key; the point stays selected.
        page.keys(*[(Keys.ALT, Keys.ARROW_UP)] * 5, "+")
        at = round((ms - 1000) / 40)
        assert abs(levels(page)[at] - before[at] - 10) <= 2 and abs(levels(page)[0] - 20) <= 1 and levels(page)[-1] == before[-1], levels(page)
        assert page.position() == ms
        page.keys(*[(Keys.ALT, Keys.ARROW_RIGHT)] * 5)
        assert page.position() == ms + 200 and min(abs(level - 30) for level in levels(page)[at + 4:at + 7]) <= 2, levels(page)
        page.keys(*[(Keys.CONTROL, "z")] * 11)
        assert levels(page) == before and not page.find("#undo").is_enabled()
        # A point in the middle of a line, which only counts once it is moved.
        page.keys("t", "1.2", Keys.ENTER, Keys.ENTER)
        assert said(page).startswith("Point 2 of 5, 0:01.200, level 20") and levels(page) == before, said(page)
        page.keys(*["+"] * 4)
        assert abs(levels(page)[5] - 40) <= 3 and levels(page)[-1] == before[-1], levels(page)
        page.keys(CTRL_LEFT)
        assert said(page).startswith("Point 1 of 5"), said(page)
        page.keys(Keys.DELETE)
        assert "keeps" in said(page) and len([each for each in page.track() if 4 in each[2]]) > 1
        page.keys(CTRL_RIGHT, Keys.DELETE)
        assert said(page).startswith("Point taken away"), said(page)
        assert all(abs(a - b) <= 3 for a, b in zip(levels(page), before)), levels(page)
        # Without a point, the keys are what they were.
        page.keys(Keys.ESCAPE, "t", "1.2", Keys.ENTER, Keys.DELETE)
        assert not any(4 in each[2] for each in page.track()), page.track()


def film_with_blows(folder):
    pick = random.Random(1)
    rate = 48000
    sound = [pick.gauss(0, 0.002) for _ in range(8 * rate)]
    for ms in BLOWS:
        for i in range(rate // 2):
            sound[ms * rate // 1000 + i] += pick.gauss(0, 0.3) * math.exp(-i / rate / 0.08)
    with wave.open(str(folder / "blows.wav"), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(struct.pack(f"<{len(sound)}h", *(max(-32768, min(32767, int(each * 32767))) for each in sound)))
    film = folder / "blows.webm"
    subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc=size=320x180:rate=25:duration=8", "-i", folder / "blows.wav", "-c:v", "libvpx", "-deadline", "realtime",
                    "-c:a", "libopus", film], check=True, timeout=120)
    film.with_suffix(".vtt").write_text(HEADER + cue(500, 900, {4: 75}), encoding="utf-8")
    return film


def edges_snap_to_impacts(driver):
    with desk_with(driver) as (_, folder), Desk(film_with_blows(folder)) as desk:
        listener = Listener(desk, "impacts", writes=False)
        page = Page(driver, desk)
        page.wait("the strip", lambda: listener.last("progress")["strip"] == 1)
        listener.leave()
        impacts = desk.get("cuts").json["impacts"]
        assert len(impacts) == 3 and all(abs(found - ms) <= 20 for found, ms in zip(impacts, BLOWS)), impacts
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 1366, "height": 1000, "deviceScaleFactor": 1, "mobile": False})
        page.load()
        page.may_write()
        page.keys("j", "w", "u")
        assert page.position() == impacts[0]
        page.keys("u", "u", (Keys.SHIFT, "u"))
        assert page.position() == impacts[1]
        page.keys(Keys.HOME)
        left, top = page.js("const { left, top } = document.querySelector('#timeline canvas').getBoundingClientRect(); return [left, top]")
        # 76 pixels are for labels; all of the film is in view.
        width, height = page.js("const { clientWidth, clientHeight } = document.querySelector('#timeline canvas'); return [clientWidth, clientHeight]")
        x = lambda ms: round(left + 76 + ms / 8000 * (width - 76))
        rows = 26 + 48 + 36
        y = round(top + rows + 5 * (height - rows) / 9 - 9)

        def drag(begin, end):
            chain = ActionChains(driver, duration=20)
            chain.w3c_actions.pointer_action.move_to_location(x(begin), y)
            chain.w3c_actions.pointer_action.pointer_down()
            chain.w3c_actions.pointer_action.move_to_location(x(begin) + 9, y)
            chain.w3c_actions.pointer_action.move_to_location(x(end) + 4, y)
            chain.w3c_actions.pointer_action.pointer_up()
            chain.perform()

        felt = lambda: [each[:2] for each in page.track() if each[2]]
        drag(700, impacts[0] + 200)
        assert felt() == [(impacts[0], impacts[0] + 400)], (felt(), impacts)
        # By its end, too, and by its edge.
        drag(impacts[0] + 200, impacts[1] - 200)
        assert felt() == [(impacts[1] - 400, impacts[1])], (felt(), impacts)
        drag(impacts[1], impacts[2])
        assert felt() == [(impacts[1] - 400, impacts[2])], (felt(), impacts)
        page.keys("j", (Keys.SHIFT, "s"))
        drag(impacts[2], impacts[1] + 1000)
        assert felt()[0][1] not in impacts
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def a_drag_moves_the_whole_event(driver):
    with desk_with(driver, [cue(5000, 6000, {4: 75})]) as (desk, _):
        page = Page(driver, desk)
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 1366, "height": 768, "deviceScaleFactor": 1, "mobile": False})
        # A part of it is selected, as after the undo of another edit.
        page.keys("j", *[Keys.ARROW_DOWN] * 4, "w", "t", "5.4", Keys.ENTER, "i", "t", "5.6", Keys.ENTER, "o", (Keys.SHIFT, "s"))
        left, top, width, height = page.js("const { left, top, width, height } = document.querySelector('#timeline canvas').getBoundingClientRect(); return [left, top, width, height]")
        above = 26 + 48 + 36
        row = max((height - above) / 9, 18)
        # The middle of a bar that is seven pixels high.
        x, y = round(left + 76 + 5500 / 20000 * (width - 76)), round(top + above + 5 * row - 6 - 0.75 * (row - 9) / 2)
        chain = ActionChains(driver, duration=20)
        pointer = chain.w3c_actions.pointer_action
        pointer.move_to_location(x, y)
        pointer.pointer_down()
        pointer.move_to_location(x + 50, y)
        pointer.move_to_location(x + 100, y)
        pointer.pointer_up()
        chain.perform()
        (start, end, levels, _), *_ = page.track()
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        assert row < 20 and (end - start, levels) == (1000, {4: 75}) and abs(start - 5000 - 100 * 20000 / (width - 76)) < 30, (row, page.track())


def rows_are_high(driver):
    with desk_with(driver, [cue(1000, 1400, {8: 50})]) as (desk, _):
        page = Page(driver, desk)
        bar = lambda: page.js("return document.querySelector('#timeline canvas').clientHeight")
        page.keys("j", *[Keys.ARROW_DOWN] * 8, "w")
        before = bar()
        page.click("#tall")
        assert page.find("#tall").get_attribute("aria-pressed") == "true" and bar() == before
        page.click("[data-tool=paint]")
        left, bottom = page.js("const { left, bottom } = document.querySelector('#timeline canvas').getBoundingClientRect(); return [left, bottom]")
        # The last row is 72 pixels high, of which 63 are for levels: half of them is the half.
        chain = ActionChains(driver, duration=20)
        pointer = chain.w3c_actions.pointer_action
        pointer.move_to_location(round(left + 300), round(bottom - 6 - 32))
        pointer.pointer_down()
        pointer.move_to_location(round(left + 340), round(bottom - 6 - 32))
        pointer.move_to_location(round(left + 380), round(bottom - 6 - 32))
        pointer.pointer_up()
        chain.perform()
        painted = {level for start, _, each, _ in page.track() for cell, level in each.items() if start > 1400}
        assert painted and all(abs(level - 50) <= 4 for level in painted), page.track()
        page.keys("y")
        assert page.find("#tall").get_attribute("aria-pressed") == "false"


def what_to_do_first_is_not_red(driver):
    with desk_with(driver, [cue(1000, 1400, {4: 75})]) as (desk, _):
        page = Page(driver, desk)
        page.click("#loop")
        page.click("#templates-tab")
        page.click("#templates button")
        page.wait("a hint", lambda: page.find("#templates > p:last-child").text)
        red = page.js("return getComputedStyle(document.body).getPropertyValue('--bad').trim()")
        hint = page.js("return getComputedStyle(document.querySelector('#templates > p:last-child')).color")
        assert page.errors() == [] and any("Select the time" in text for text in page.news()), (page.errors(), page.news())
        error = page.js("document.body.style.color = arguments[0]; const { color } = getComputedStyle(document.body); document.body.style.color = ''; return color", red)
        assert hint != error, hint
        # A mistake is.
        page.click("#selection-tab")
        page.keys("j")
        page.go_to(1100)
        page.keys("j", *[Keys.ARROW_DOWN] * 4, Keys.ENTER, "p", (Keys.CONTROL, "a"), "soon", Keys.ENTER)
        page.wait("an error", page.errors)
        assert page.js("return getComputedStyle(document.querySelector('#alerts li')).color") == error


TESTS = [points_by_keys, edges_snap_to_impacts, a_drag_moves_the_whole_event, rows_are_high, what_to_do_first_is_not_red]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
