#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scripts in examples/ that start visuotactile-follow from within a player: in a real mpv, in a real Kodi in Xvfb, and with a stub of Kodi.

Expects what follow_stage.py does, kodi and Xvfb.
Usage: follow_scripts.py [PART ...]      of mpv_script, kodi_addon, in_kodi; all by default"""

import json
import os
import pathlib
import shutil
import socket
import subprocess
import time
import xml.etree.ElementTree

import dbus
from follow_stage import FOLLOW, LATEST, NAME, Mpv, make_film, make_track, make_wrapper, run, start, vest, wait_until, work

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"

def mpv_script():
    """mpv's own script starts a follower, moves it by keys, and uses one that runs."""
    wrapper = make_wrapper('"$@"')
    (work / "log").write_text("", encoding="utf-8")
    film = make_film("script.mkv", 60, pattern=None)
    make_track(film.with_suffix(".csv"), 60)
    os.environ["PATH"] = f"{wrapper.parent}:{os.environ['PATH']}"
    script = EXAMPLES / "mpv/visuotactile.lua"
    options = f"--script-opts=visuotactile-options=--driver=bhaptics --device={vest.device}"
    remembered = work / "config/visuotactile/follow.conf"
    mpv = Mpv(film, f"--script={script}", options)
    vest.wait_to_feel()
    mpv.command("keypress", "Ctrl+Alt+RIGHT")
    wait_until("a nudge by a key", lambda: remembered.exists() and "offset=10\n" in remembered.read_text(encoding="utf-8"))
    mpv.command("keypress", "Ctrl+Alt+LEFT")
    wait_until("a nudge back", lambda: "offset=0\n" in remembered.read_text(encoding="utf-8"))
    mpv.quit()
    bus = dbus.SessionBus(private=True)
    wait_until("the follower's end", lambda: not bus.name_has_owner(NAME))
    assert vest.is_silent()
    # One that runs is used, at the socket where it looks.
    (work / "calls").unlink()
    os.environ["XDG_RUNTIME_DIR"] = str(work)
    running = start(FOLLOW, "--driver=bhaptics", f"--device={vest.device}", stderr=subprocess.DEVNULL)
    wait_until("a follower", lambda: bus.name_has_owner(NAME))
    viewer = start("mpv", "--no-config", "--vo=null", "--ao=null", f"--script={script}", str(film), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    vest.wait_to_feel()
    assert (work / "calls").read_text(encoding="utf-8") == "--status\nstatus 0\n"
    viewer.terminate()
    viewer.wait(LATEST)
    wait_until("silence", vest.is_silent)
    running.terminate()
    assert running.wait(LATEST) == 0
    remembered.unlink()
    shutil.rmtree(film.parent)


KODI = """import os, time
LOGERROR = 4
def log(text, level):
    print(level, text, flush=True)
class Monitor:
    def waitForAbort(self, timeout=0):
        end = time.monotonic() + timeout if timeout else float("inf")
        while time.monotonic() < end and not os.path.exists(os.environ["ABORT"]):
            time.sleep(0.01)
        return os.path.exists(os.environ["ABORT"])
"""


def kodi_addon():
    """Kodi's add-on, with a stub of Kodi's own module: it starts a follower and ends it."""
    folder, modules, abort = EXAMPLES / "kodi/service.visuotactile", work / "modules", work / "abort"
    extension = xml.etree.ElementTree.parse(folder / "addon.xml").find("extension[@point='xbmc.service']")
    modules.mkdir()
    (modules / "xbmc.py").write_text(KODI, encoding="utf-8")
    film = make_film("addon.mkv", 60, pattern=None)
    make_track(film.with_suffix(".csv"), 60)
    mpv = Mpv(film)
    wrapper = make_wrapper(f'"$@" --mpv={mpv.path} --driver=bhaptics --device={vest.device}')

    def start_addon(path):
        return start("/usr/bin/python3", str(folder / extension.get("library")), text=True, stdout=subprocess.PIPE,
                     env=dict(os.environ, PYTHONPATH=str(modules), PYTHONDONTWRITEBYTECODE="1", ABORT=str(abort), PATH=path))

    bus = dbus.SessionBus(private=True)
    addon = start_addon(f"{wrapper.parent}:{os.environ['PATH']}")
    vest.wait_to_feel()
    second = start_addon(f"{wrapper.parent}:{os.environ['PATH']}")
    wait_until("an answer", lambda: "status 0\n" in (work / "calls").read_text(encoding="utf-8"))
    abort.touch()
    assert addon.wait(LATEST) == 0 and second.wait(LATEST) == 0
    assert (work / "calls").read_text(encoding="utf-8").split("\n") == ["--status", "status 1", "--quiet", "--status", "status 0", ""]
    wait_until("its end", lambda: not bus.name_has_owner(NAME))
    wait_until("silence", vest.is_silent)
    abort.unlink()
    # It is not installed, or ends.
    missing = start_addon(str(work))
    assert missing.wait(LATEST) == 0 and "4 visuotactile-follow cannot be started" in missing.stdout.read()
    wrapper.write_text("#!/bin/sh\necho it is broken >&2\nexit 1\n", encoding="utf-8")
    broken = start_addon(f"{wrapper.parent}:{os.environ['PATH']}")
    assert broken.wait(LATEST) == 0 and "it is broken" in broken.stdout.read()
    mpv.quit()
    wrapper.unlink()
    shutil.rmtree(film.parent)


def in_kodi():
    """The add-on in a real Kodi, in Xvfb: what Kodi plays is felt, and nothing when Kodi has ended."""
    film = make_film("kodi.mkv", 60, pattern=None)
    make_track(film.with_suffix(".csv"), 60)
    home = work / "kodi"
    shutil.copytree(EXAMPLES / "kodi", home / ".kodi/addons")
    (home / ".kodi/userdata").mkdir()
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
    (home / ".kodi/userdata/advancedsettings.xml").write_text(
        f"<advancedsettings version='1.0'><jsonrpc><tcpport>{port}</tcpport></jsonrpc></advancedsettings>", encoding="utf-8")
    wrapper = make_wrapper(f'"$@" --kodi=127.0.0.1:{port} --driver=bhaptics --device={vest.device}')
    screen = start("Xvfb", "-displayfd", "1", "-noreset", "-screen", "0", "640x360x24", stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    viewer = start("kodi", "--windowing=x11", "--gl-interface=glx", "--audio-backend=alsa", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
                   env=dict(os.environ, HOME=str(home), PATH=f"{wrapper.parent}:{os.environ['PATH']}", LIBGL_ALWAYS_SOFTWARE="1",
                            DISPLAY=f":{screen.stdout.readline().strip()}"))
    line = socket.socket()

    def connects():
        nonlocal line
        assert viewer.poll() is None, "Kodi has ended"
        try:
            line.connect(("127.0.0.1", port))
        except OSError:
            line = socket.socket()
            return False
        return True

    def call(method, **parameters):
        line.sendall(json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": parameters}).encode())

    wait_until("Kodi's port", connects)
    bus = dbus.SessionBus(private=True)
    while not bus.name_has_owner(NAME):  # until Kodi has found its add-ons
        call("Addons.SetAddonEnabled", addonid="service.visuotactile", enabled=True)
        assert viewer.poll() is None, "Kodi has ended"
        time.sleep(0.5)
    call("Player.Open", item={"file": str(film)})
    vest.wait_to_feel()
    call("Application.Quit")
    wait_until("the follower's end", lambda: not bus.name_has_owner(NAME))
    wait_until("silence", vest.is_silent)
    viewer.wait(LATEST)
    screen.kill()
    wrapper.unlink()
    shutil.rmtree(film.parent)


run({"mpv_script": mpv_script, "kodi_addon": kodi_addon, "in_kodi": in_kodi})
