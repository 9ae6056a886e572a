#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A page without a track in a real Chromium: visuotactile-follow finds one by the page's title and the film's length; without any, the extension
of examples/chromium offers to make one of a file, which is then found while the film plays.

Expects FOLLOW, TRACK, the plugins on GST_PLUGIN_PATH, Chromium, Xvfb and dbus-daemon."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from follow_players import Bus, Gio, LATEST, wait_until
from gi.repository import GLib
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

from desk_driver import make_film

EXTENSION = pathlib.Path(__file__).resolve().parents[2] / "examples/chromium"
SECONDS = 20
OPTIONS = ("--no-sandbox --no-first-run --disable-background-networking --disable-component-update --disable-sync --disable-gpu "
           "--autoplay-policy=no-user-gesture-required --password-store=basic")
NAME = "org.visuotactile.Follow1"
TRACK = "WEBVTT\n\nNOTE tactile grid=1x1 rate=5\n\n00:00:01.000 --> 00:00:{:02}.000\n 50\n"

folder = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-page-"))
started = []


def start(*words, **options):
    started.append(subprocess.Popen(words, **options))
    return started[-1]


def property_of(bus, name):
    try:
        value, = bus.call_sync(NAME, "/org/visuotactile/Follow1", "org.freedesktop.DBus.Properties", "Get", GLib.Variant("(ss)", (NAME, name)),
                               None, Gio.DBusCallFlags.NO_AUTO_START, 1000 * LATEST, None).unpack()
        return value
    except GLib.Error:  # it is not there yet
        return ""


try:
    display = start("Xvfb", "-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    session = Bus(folder)
    programs = folder / "programs"
    programs.mkdir()
    (programs / "zenity").write_text(f"#!/bin/sh\necho {folder}/mine.webm\n", encoding="utf-8")
    # Its progress, as on a film that takes longer.
    (programs / "tactile-track").write_text(f"#!/bin/sh\ntest -t 2 && printf '\\r\\033[K37 %% of 1 films' >&2\nexec {os.environ['TRACK']} \"$@\"\n", encoding="utf-8")
    for name in ("zenity", "tactile-track"):
        (programs / name).chmod(0o755)
    env = dict(os.environ, HOME=str(folder), XDG_RUNTIME_DIR=str(folder), DISPLAY=f":{display.stdout.readline().strip()}", DBUS_SESSION_BUS_ADDRESS=session.address,
               XDG_CONFIG_HOME=str(folder / "config"), XDG_CACHE_HOME=str(folder / "cache"), PATH=f"{programs}:{os.environ['PATH']}")
    bus = session.connection()
    make_film(folder / "made.webm", SECONDS)
    # Chromium cannot seek in webmmux's film with sound where it is a file.
    subprocess.run(["ffmpeg", "-v", "error", "-i", folder / "made.webm", "-c", "copy", folder / "mine.webm"], check=True, timeout=LATEST)
    (folder / "page.html").write_text("<!DOCTYPE html><meta charset=utf-8><title>Watch Bouncing Balls (2012) in full – Some Site</title><video src=mine.webm loop></video>", encoding="utf-8")
    tracks = folder / "tracks"
    tracks.mkdir()
    (tracks / "Bouncing Balls.vtt").write_text(TRACK.format(SECONDS - 1), encoding="utf-8")
    (tracks / "Watch Balls in full.vtt").write_text(TRACK.format(SECONDS - 9), encoding="utf-8")  # more words, another length
    start(os.environ["FOLLOW"], "--driver=simulator", f"--tracks={tracks}", env=env)

    profile = folder / "profile"
    extension = shutil.copytree(EXTENSION, folder / "extension")
    subprocess.run([extension / "host.py", "--install", profile], check=True, env=env, timeout=LATEST)
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for option in [*OPTIONS.split(), f"--user-data-dir={profile}", f"--load-extension={extension}"]:
        options.add_argument(option)
    driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver", env=env), options=options)
    try:
        driver.set_script_timeout(LATEST)
        driver.get((folder / "page.html").as_uri())
        driver.execute_script("document.querySelector('video').play()")
        film = driver.current_window_handle
        wait_until("the title", lambda: "Bouncing" in property_of(bus, "Film"))
        wait_until("the track of that title and length", lambda: "Bouncing Balls.vtt" in property_of(bus, "Track"))
        print("ok by title and length", flush=True)

        # A page with another title: nothing fits, and the extension offers.
        driver.execute_script("document.title = 'A film of mine'; document.querySelector('video').load(); document.querySelector('video').play()")
        wait_until("no track", lambda: property_of(bus, "Film") == "A film of mine" and not property_of(bus, "Track"))
        driver.switch_to.new_window("tab")
        key, = {line.split('"')[1] for line in (extension / "host.py").read_text(encoding="utf-8").splitlines() if line.startswith("EXTENSION")}
        driver.get(f"chrome-extension://{key}/offer.html")
        badge = lambda: driver.execute_async_script("chrome.action.getBadgeText({}).then(arguments[0])")
        said = lambda: driver.find_element("id", "text").text
        wait_until("what is missing", lambda: "no track for “A film of mine”" in said())
        wait_until("the offer on the button", lambda: badge() == "+")
        driver.execute_script("window.told = []; chrome.runtime.onMessage.addListener(({ text }) => { told.push(text ?? ''); })")
        driver.find_element("id", "make").click()
        made = tracks / "A film of mine.vtt"
        wait_until("a track", lambda: made.exists() or "No track" in said())
        wait_until("the end", lambda: "has a track now" in said())
        told = driver.execute_script("return told")
        assert any(text.endswith("is being made: 37 %") for text in told), told
        subprocess.run([os.environ["TRACK"], "validate", made], check=True, timeout=LATEST, stdout=subprocess.DEVNULL)
        wait_until("the film to be felt", lambda: "A film of mine.vtt" in property_of(bus, "Track"))
        driver.refresh()
        wait_until("what is felt", lambda: "is felt" in said())
        assert not driver.find_element("id", "make").is_displayed()
        print("ok the offer", flush=True)
    except BaseException:
        print({name: property_of(bus, name) for name in ("Player", "State", "Film", "Track", "Library")}, file=sys.stderr)
        raise
    finally:
        driver.quit()
finally:
    for process in reversed(started):
        process.terminate()
        process.wait(LATEST)
    session.stop()
    shutil.rmtree(folder, ignore_errors=True)
