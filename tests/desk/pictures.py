#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of the desk with a real film, at the sizes of a small and a large screen, light, dark and at 200 %.

Usage: pictures.py FILM FOLDER      expects the environment of desk_page.py; writes PNG files into FOLDER
"""
import pathlib
import shutil
import sys
import tempfile

from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Desk, HEADER, Listener, Page, cue

EVENTS = [cue(900, 1300, {4: 60}, ["the door opens"]), cue(2000, 2400, {3: 40}), cue(2400, 2800, {3: 65, 4: 30}), cue(2800, 3200, {3: 90, 4: 50}),
          cue(5200, 8000, {0: 70, 1: 70, 2: 70, 3: 60, 5: 60}), cue(8600, 9000, {7: 80}), cue(11000, 11900, {1: 100}), cue(13000, 13300, {8: 55})]
LIGHT, DARK = "light", "dark"
SMALL, LARGE, DOUBLE = (1366, 768, 1), (1920, 1080, 1), (1280, 800, 2)  # width, height, scale


def shown(page, size, colors=LIGHT):
    """The page at a size, in colors, as soon as it is drawn."""
    width, height, scale = size
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": colors}]})
    page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width // scale, "height": height // scale, "deviceScaleFactor": scale, "mobile": False})
    for _ in range(3):
        page.driver.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))")


def main():
    film, folder = map(pathlib.Path, sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name, chromium() as driver:
        copy = pathlib.Path(name) / film.name
        shutil.copy(film, copy)
        copy.with_suffix(".vtt").write_text(HEADER + "".join(EVENTS), encoding="utf-8")
        with Desk(copy) as desk:
            page = Page(driver, desk)
            listener = Listener(desk, "pictures", writes=False)
            page.wait("thumbnails and sound", lambda: listener.last("progress")["strip"] == 1)
            has_draft = listener.last("progress")["draft"] == 1  # tactile-track author is slow on a busy machine
            listener.leave()
            page.load()
            page.may_write()
            page.go_to(2500)
            page.keys("j", *[Keys.ARROW_DOWN] * 3, Keys.ENTER, "w")
            page.wait("thumbnails", lambda: page.js("return performance.getEntriesByType('resource').filter((e) => e.name.includes('thumbnail?')).length > 5"))

            def picture(name, size, colors=LIGHT):
                shown(page, size, colors)
                driver.save_screenshot(str(folder / f"{name}.png"))
                print(folder / f"{name}.png", flush=True)

            picture("light", SMALL)
            picture("dark", LARGE, DARK)
            picture("large", DOUBLE)
            page.click("[data-tool=curve]")
            picture("curve", SMALL)
            page.click("[data-tool=draw]")
            if has_draft:
                page.keys("v")
                picture("review", SMALL)
                page.keys("v")
            page.click("#full")
            picture("full", SMALL, DARK)


if __name__ == "__main__":
    main()
