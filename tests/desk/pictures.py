#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of the desk with a real film, at the sizes of a small and a large screen, light, dark and at 200 %.

Usage: pictures.py FILM FOLDER      expects the environment of desk_page.py; writes PNG files into FOLDER
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Desk, HEADER, Page, cue

EVENTS = [cue(900, 1300, {4: 60}, ["the door opens"]), cue(2000, 2400, {3: 40}), cue(2400, 2800, {3: 65, 4: 30}), cue(2800, 3200, {3: 90, 4: 50}),
          cue(5200, 8000, {0: 70, 1: 70, 2: 70, 3: 60, 5: 60}), cue(8600, 9000, {7: 80}), cue(11000, 11900, {1: 100}), cue(13000, 13300, {8: 55})]
SIZES = {"small": (1366, 768, 1), "large": (1920, 1080, 1), "double": (1280, 800, 2)}


def dark(driver, on):
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark" if on else "light"}]})


def size(driver, name):
    width, height, scale = SIZES[name]
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width // scale, "height": height // scale, "deviceScaleFactor": scale, "mobile": False})


def picture(page, path):
    page.js("document.getElementById('timeline').getBoundingClientRect()")
    page.driver.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))")
    page.driver.save_screenshot(str(path))
    print(path, flush=True)


def main():
    film, folder = map(pathlib.Path, sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name, chromium() as driver:
        copy = pathlib.Path(name) / film.name
        shutil.copy(film, copy)
        copy.with_suffix(".vtt").write_text(HEADER + "".join(EVENTS), encoding="utf-8")
        with Desk(copy) as desk:
            page = Page(driver, desk)
            page.wait("thumbnails", lambda: page.js("return performance.getEntriesByType('resource').some((e) => e.name.includes('thumbnail?'))"))
            page.go_to(2500)
            page.keys("j", "i", "o", Keys.ESCAPE)
            for screen in SIZES:
                size(driver, screen)
                for on in (False, True):
                    dark(driver, on)
                    picture(page, folder / f"{screen}-{'dark' if on else 'light'}.png")


if __name__ == "__main__":
    main()
