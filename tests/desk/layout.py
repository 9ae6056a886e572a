#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Where things are on the page: splitters, the film over the screen, tabs, tools, and what is in view without scrolling.

Usage: layout.py [TEST ...]
"""
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Page, cue, desk_with, run

CUES = [cue(1000, 1400, {4: 75}), cue(2000, 6000, {0: 40})]
TIMELINE = "return document.activeElement.matches('#timeline canvas')"


def size(driver, width, height):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})


def box(page, css):
    return page.js("const { left, top, right, bottom, width, height } = document.querySelector(arguments[0]).getBoundingClientRect(); return { left, top, right, bottom, width, height }", css)


def hidden_parts(page, css):
    """Controls that one has to scroll to."""
    return page.js("""return [...document.querySelectorAll(arguments[0])].filter((e) => e.checkVisibility()).filter((e) => {
        const { left, top, right, bottom } = e.getBoundingClientRect();
        const pane = e.closest('section')?.getBoundingClientRect() ?? { top: 0, bottom: innerHeight, left: 0, right: innerWidth };
        return top < pane.top - 1 || bottom > Math.min(pane.bottom, innerHeight) + 1 || left < pane.left - 1 || right > pane.right + 1;
      }).map((e) => e.id || e.textContent || e.name)""", css)


def all_is_in_view_on_a_small_screen(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        try:
            size(driver, 1366, 768)
            page.keys("j", "i", "o")
            for name in ("templates", "operations", "warnings", "selection"):
                page.click(f"#{name}-tab")
                assert page.find(f"#{name}-pane").is_displayed()
                missed = hidden_parts(page, f"#tabs button, .tools button, .transport button, .transport input, #cells button, header button, #{name}-pane :is(button, input, select, textarea)")
                assert missed == [], (name, missed)
            assert page.js("return document.documentElement.scrollHeight <= innerHeight")
        finally:
            driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def splitters_by_keys_and_pointer(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        try:
            size(driver, 1366, 768)
            before = box(page, ".screen")
            for name in ("split-film", "split-track"):
                page.js("document.getElementById(arguments[0]).focus()", name)
                page.keys(Keys.END)
            grown = box(page, ".screen")
            assert grown["width"] > 1.6 * before["width"] and grown["height"] > 1.6 * before["height"], (before, grown)
            assert abs(grown["width"] / grown["height"] - 16 / 9) < 0.02, grown
            assert box(page, "#timeline")["bottom"] <= 768 and box(page, "#panel")["width"] > 150, (box(page, "#timeline"), box(page, "#panel"))
            assert page.find("#split-film").get_attribute("aria-valuenow") == "70"
            page.load()
            assert abs(box(page, ".screen")["width"] - grown["width"]) < 2, "the browser remembers it"
            page.js("document.getElementById('split-film').focus()")
            page.keys(Keys.ENTER)
            page.js("document.getElementById('split-track').focus()")
            page.keys(Keys.ENTER, Keys.ARROW_DOWN)
            assert page.find("#split-track").get_attribute("aria-valuenow") == "47"
            page.keys(Keys.ENTER)
            assert abs(box(page, ".screen")["width"] - before["width"]) < 2
            ActionChains(driver, duration=20).drag_and_drop_by_offset(page.find("#split-film"), 200, 0).perform()
            assert abs(box(page, "#film")["width"] - 1350 * 0.43 - 200) < 20, box(page, "#film")
        finally:
            page.js("localStorage.removeItem('desk-layout')")
            driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def full_screen_has_the_grid_over_the_film(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        page.click("#full")
        page.wait("the full screen", lambda: page.js("return document.fullscreenElement !== null"))
        page.wait("a film as large as the window", lambda: box(page, ".screen")["width"] > 0.9 * page.js("return innerWidth") or box(page, ".screen")["height"] > 0.9 * page.js("return innerHeight") - 60)
        film, cells = box(page, ".screen"), box(page, "#cells")
        assert all(abs(film[side] - cells[side]) < 2 for side in film), (film, cells)
        assert not page.find("#timeline").is_displayed() and page.find("#play").is_displayed() and page.find("#record").is_displayed()
        page.go_to(5000)
        page.keys("r")
        page.find("#cells button:nth-child(9)").click()
        page.keys("r", "e")
        page.wait("the window", lambda: page.js("return document.fullscreenElement === null") and page.find("#timeline").is_displayed())
        assert (5000, 5200, {8: 75}, []) in page.track() or any(each[2].get(8) for each in page.track()), page.track()


def tools_are_buttons_with_keys(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        pressed = lambda: [each.get_attribute("data-tool") for each in page.all("[data-tool][aria-pressed=true]")]
        assert pressed() == ["draw"]
        for key, tool in zip("qbhxd", ("select", "paint", "curve", "cut", "draw")):
            page.keys("j", key)
            assert pressed() == [tool], tool
        page.click("[data-tool=cut]")
        assert pressed() == ["cut"]
        page.click("#snap")
        assert page.find("#snap").get_attribute("aria-pressed") == "false"
        assert not page.find("#zoom-selection").is_enabled()
        page.keys("j", (Keys.CONTROL, "a"))
        assert page.find("#zoom-selection").is_enabled()


def enter_in_a_field_gives_the_keyboard_back(driver):
    with desk_with(driver, [cue(1000, 1400, {4: 75})]) as (desk, _):
        page = Page(driver, desk)
        page.keys("t", "1.1", Keys.ENTER)
        assert page.js(TIMELINE) and abs(page.position() - 1100) <= 1
        page.keys(*[Keys.ARROW_DOWN] * 4, Keys.ENTER, "p", Keys.TAB, Keys.TAB, (Keys.CONTROL, "a"), "40", Keys.ENTER)
        page.wait("the level", lambda: page.track()[0][2] == {4: 40})
        assert page.js(TIMELINE)
        page.keys("t", "soon", Keys.ENTER)
        assert not page.js(TIMELINE), "a mistake is corrected first"


TESTS = [all_is_in_view_on_a_small_screen, splitters_by_keys_and_pointer, full_screen_has_the_grid_over_the_film, tools_are_buttons_with_keys, enter_in_a_field_gives_the_keyboard_back]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
