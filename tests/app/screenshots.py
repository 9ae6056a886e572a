#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the pictures of the window: each page light, dark and at 200 %, and one in German; and of the film's window, which has no colors of its
own. Expects APP and the plugins on GST_PLUGIN_PATH.

Usage: meson devenv -C build env APP=tools/visuotactile ../tests/app/screenshots.py ../docs/images/app"""

import os
import pathlib
import subprocess
import sys

os.environ["SCREEN"] = "1600x1400x24"

from app_window import App, picture, start, wait_until, work  # noqa: E402

folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
CHAIR = work / "config/visuotactile/chair.conf"
CHAIR.parent.mkdir(parents=True)
CHAIR.write_text("[chair]\ndriver=simulator\n", encoding="utf-8")
FILM = work / "Bouncing balls.mkv"
subprocess.run([*"gst-launch-1.0 -q tactiletestsrc num-buffers=60 ! video/x-raw,width=160,height=120 ! jpegenc ! matroskamux ! filesink".split(), f"location={FILM}"], check=True)


def take(suffix="", scale=1, pages=("chair", "film", "players"), feel=("Feel all motors", "row "), **environment):
    app = App(FILM, **environment)
    app.find("label", "⚠")
    for page in pages:
        app.key(f"ctrl+{1 + ('chair', 'film', 'players').index(page)}")
        if page == "chair":
            app.click("button", feel[0])
            wait_until("a motor", lambda: app.find_now("label", feel[1]))
        else:
            app.find("button" if page == "film" else "check box", "Open a film" if page == "film" else "mpv")
        picture(folder / f"{page}{suffix}.png", 760 * scale, 640 * scale)
    app.quit()


def take_film_window():
    """At the film's size, after a key, and in full screen."""
    player = start(pathlib.Path(os.environ["APP"]).with_name("visuotactile-play"), "--driver=simulator", stderr=subprocess.PIPE, text=True)
    while not player.stderr.readline().startswith("Playing"):
        pass
    window = subprocess.run(["xdotool", "search", "--sync", "--name", " of "], check=True, capture_output=True, text=True).stdout.split()[0]
    title = lambda: subprocess.run(["xdotool", "getwindowname", window], check=True, capture_output=True, text=True).stdout
    wait_until("the balls", lambda: "0:02 of" in title())
    for name, key in (("play", "minus"), ("play-full", "f")):
        subprocess.run(["xdotool", "key", "--window", window, key], check=True)
        shape = lambda: dict(line.split("=") for line in subprocess.run(["xdotool", "getwindowgeometry", "--shell", window], check=True, capture_output=True, text=True).stdout.split())
        wait_until("the window", lambda: name == "play" or shape()["WIDTH"] == "1600")
        picture(folder / f"{name}.png", int(shape()["WIDTH"]), int(shape()["HEIGHT"]))
    player.terminate()


take()
take_film_window()
take("-dark", GTK_THEME="Adwaita:dark")
take("-200", 2, GDK_SCALE="2")
take("-de", pages=("chair",), feel=("Motoren fühlen", "Reihe "), LC_ALL="C.UTF-8", LANGUAGE="de")
