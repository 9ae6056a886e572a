#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the pictures of the window: light, dark, and at 200 %. Expects APP and the plugins on GST_PLUGIN_PATH.

Usage: meson devenv -C build env APP=tools/visuotactile ../tests/app/screenshots.py ../docs/images/app"""

import os
import pathlib
import sys

os.environ["SCREEN"] = "1200x1600x24"

from app_window import App, picture, wait_until, work  # noqa: E402

folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
CHAIR = work / "config/visuotactile/chair.conf"
CHAIR.parent.mkdir(parents=True)


def take(name, page, width, height, start="Feel all motors", **environment):
    CHAIR.write_text("[chair]\ndriver=simulator\n", encoding="utf-8")
    app = App(**environment)
    app.find("label", "⚠")
    app.key(f"ctrl+{page}")
    if page == 1:
        app.click("push button", start)
        wait_until("a motor", lambda: app.find_now("label", "row "))
    else:
        app.find("push button" if page == 2 else "check box", "Open a film" if page == 2 else "mpv")
    picture(folder / f"{name}.png", width, height)
    app.quit()


take("chair", 1, 560, 790)
take("chair-dark", 1, 560, 790, GTK_THEME="Adwaita:dark")
take("film", 2, 560, 790)
take("players", 3, 560, 790)
take("chair-200", 1, 1120, 1580, GDK_SCALE="2")
take("chair-de", 1, 560, 790, "Motoren fühlen", LC_ALL="C.UTF-8", LANGUAGE="de")
