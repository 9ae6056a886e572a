#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window of visuotactile, used as by a screen reader and by keys.

Expects APP, SERVER (haptic_server.py), and the plugins on GST_PLUGIN_PATH. Usage: app.py [TEST ...]"""

import os
import pathlib
import socket
import subprocess
import sys
import time

from app_window import App, Atspi, settings, start, wait_until, work

CHAIR = work / "config/visuotactile/chair.conf"


def set_chair(*lines):
    CHAIR.parent.mkdir(parents=True, exist_ok=True)
    CHAIR.write_text("\n".join(["[chair]", *lines, ""]), encoding="utf-8")


def levels():
    """The highest predicted amplitude of each motor of the simulator's file; none of one that was stopped before it began."""
    lines = (work / "amplitudes.csv").read_text(encoding="utf-8").split("\n")[1:-1]  # complete ones, without the header
    rows = [[float(field) for field in line.split(",")][1:] for line in lines]
    return [max(column) for column in zip(*rows)]


def runs(process):
    """Whether that process is a visuotactile-play that has not ended."""
    try:
        name, _, rest = pathlib.Path("/proc", process, "stat").read_text().partition(")")
    except FileNotFoundError:
        return False
    return "visuotactile-pl" in name and rest.split()[0] != "Z"


def tab_to(app, role, name):
    """Moves the focus there by the keyboard alone."""
    for _ in range(40):
        app.key("Tab")
        if app.find_now(role, name, [Atspi.StateType.FOCUSED]):
            return
    raise AssertionError(f"Tab does not reach {role} '{name}'")


def finds_devices():
    state = work / "state/visuotactile/device"
    state.parent.mkdir(parents=True)
    state.write_text("gamepad\n/dev/input/event3\nBob's pad (/dev/input/event3)\n", encoding="utf-8")
    app = App()
    app.find("label", "No device is connected")
    app.find("button", "Bob's pad (/dev/input/event3), not connected now")
    # A server that listens, where Intiface does; none is connected to.
    with socket.create_server(("127.0.0.1", 12345)) as server:
        app.click("button", "Look again")
        app.find("text", "Device of Intiface")
        assert not app.has("No device is connected")
        server.setblocking(False)
        try:
            server.accept()
            raise AssertionError("the window connects to a server")
        except BlockingIOError:
            pass
    app.quit()


def chooses_by_keys():
    """Walking through the devices chooses none; a key does, and what belongs to the former one is kept."""
    set_chair("driver=auto", "grid=2x2", "mapping=3,2,1,0", "intensity=0.333")
    before = CHAIR.read_text(encoding="utf-8")
    app = App()
    app.find("button", "No hardware")
    tab_to(app, "button", "The board")
    focused = [Atspi.StateType.FOCUSED]
    for key, name in (("Down", "No hardware"), ("Up", "The board"), ("Down", "No hardware")):
        app.key(key)
        app.find("button", name, focused)
    assert CHAIR.read_text(encoding="utf-8") == before
    app.key("space")
    wait_until("the driver", lambda: "driver=simulator" in settings())
    assert settings()[:3] == ["[chair]", "driver=simulator", "intensity=0.333"], settings()
    app.find("button", "No hardware", [Atspi.StateType.PRESSED])
    app.key("Up")
    app.key("Return")
    wait_until("the mapping of before", lambda: "mapping=3,2,1,0" in settings() and "driver=auto" in settings() and "grid=2x2" in settings())
    tab_to(app, "", "Delay (ms)")
    app.key("Up")
    wait_until("the delay", lambda: "delay=5" in settings())
    assert "intensity=0.333" in settings()  # which was not touched
    app.quit()


def tests_what_was_chosen():
    """A device that was just chosen and a factor that was just set hold for the feel test that begins at once."""
    set_chair("driver=simulator", f"device={work / 'amplitudes.csv'}", "grid=1x1", "mute=false")
    app = App()
    app.find("button", "No hardware", [Atspi.StateType.PRESSED])
    tab_to(app, "slider", "Intensity")
    app.key("Home")
    app.click("button", "row 1, column 1")
    wait_until("the end of the test", lambda: (work / "amplitudes.csv").exists() and app.find_now("button", "Feel all motors"))
    assert max(levels(), default=0) == 0, levels()
    app.click("button", "The board")
    app.click("button", "Feel all motors")
    app.find("label", "motors are simulated")
    app.quit()


def feels_motors():
    set_chair("driver=simulator", f"device={work / 'amplitudes.csv'}", "grid=8x8")
    app = App()
    app.click("button", "row 2, column 1")
    wait_until("the end of the test", lambda: (work / "amplitudes.csv").exists() and app.find_now("button", "Feel all motors"))
    felt = levels()
    assert felt[8] > 0.5 and max(felt[:8] + felt[9:]) == 0, felt
    app.click("button", "Feel all motors")
    app.click("button", "Stop the feel test")
    app.find("button", "Feel all motors")
    felt = levels()
    assert max(felt[63:], default=0) == 0 and not app.has("visuotactile-play"), felt
    (work / "amplitudes.csv").unlink()
    app.click("button", "Feel all motors")
    wait_until("the test", lambda: (work / "amplitudes.csv").exists() and levels() and levels()[0] > 0)
    children = pathlib.Path("/proc", str(app.process.pid), "task", str(app.process.pid), "children").read_text(encoding="ascii").split()
    tests = [child for child in children if runs(child)]
    assert tests, "the window runs no test"
    app.process.kill()
    wait_until("the end of the test of a killed window", lambda: not any(map(runs, tests)))


def switches_all_off():
    """A film that plays is silent at once, and so is the next one."""
    server = start(sys.executable, os.environ["SERVER"], "bhaptics", stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    port = server.stdout.readline().split()[-1]
    set_chair("driver=bhaptics", f"device=vest-back@127.0.0.1:{port}")
    app = App()

    def play():
        return start(os.path.join(os.path.dirname(os.environ["APP"]), "visuotactile-play"), "--no-window", "--quiet", stdout=subprocess.DEVNULL)

    def waits_for_motors(on):
        while True:
            line = server.stdout.readline()
            assert line, "the server has ended"
            if line.startswith("motors") and ("=" in line) == on:
                return

    player = play()
    waits_for_motors(True)
    app.click("", "Switch all vibration off")
    wait_until("the setting", lambda: "mute=true" in settings())
    app.find("label", "All vibration is off.")
    server.stdin.write("marked=1\n")
    server.stdin.flush()
    while not server.stdout.readline().startswith("set marked"):
        pass
    last = play()  # begins silent, and plays to its end after the first one
    assert player.wait() == 0 and last.wait() == 0
    app.key("ctrl+m")
    wait_until("the setting", lambda: "mute=false" in settings())
    server.stdin.write("quit\n")
    server.stdin.flush()
    felt = [line for line in server.stdout.read().split("\n") if line.startswith("motors") and "=" in line]
    assert len(felt) < 20, len(felt)  # what was under way: a whole film has about 195
    app.quit()


def switches_players():
    tools = work / "bin"
    tools.mkdir()
    for name in ("systemctl", "mpv", "kodi", "totem"):
        (tools / name).write_text(f'#!/bin/sh\necho "$@" >>{work}/calls\n', encoding="utf-8")
        (tools / name).chmod(0o755)
    app = App(PATH=f"{tools}:{os.path.dirname(os.environ['APP'])}:{os.environ['PATH']}")
    app.key("ctrl+3")
    app.click("check box", "Totem")
    wait_until("Totem's section", lambda: "[totem]" in settings() and "enabled=true" in settings())
    link = work / "config/mpv/scripts/visuotactile.lua"
    app.click("check box", "mpv")
    wait_until("mpv's script", link.is_symlink)
    assert "visuotactile-follow" in link.read_text(encoding="utf-8")
    wait_until("the state", lambda: app.find("check box", "mpv").get_state_set().contains(Atspi.StateType.CHECKED))
    app.click("check box", "mpv")
    wait_until("mpv without a script", lambda: not link.is_symlink())
    app.click("check box", "Any player")
    wait_until("systemd", lambda: (work / "calls").exists() and "--user --now enable visuotactile-follow.service" in (work / "calls").read_text(encoding="utf-8"))
    # A file of the user stays, and the window reports it.
    tab_to(app, "check box", "Totem")
    CHAIR.write_text(CHAIR.read_text(encoding="utf-8") + "\n[parole]\nenabled=true\n", encoding="utf-8")
    wait_until("the state of Parole", lambda: app.find("check box", "Parole").get_state_set().contains(Atspi.StateType.CHECKED))
    app.find("check box", "Totem", [Atspi.StateType.FOCUSED])  # a change elsewhere moves no focus
    wait_until("the state of mpv", lambda: not app.find("check box", "mpv").get_state_set().contains(Atspi.StateType.CHECKED))
    link.write_text("mine", encoding="utf-8")
    app.click("check box", "mpv")
    app.find("label", "not by this program")
    assert link.read_text(encoding="utf-8") == "mine"
    app.quit()


def plays_a_film():
    film = work / "film.mkv"
    subprocess.run(f"gst-launch-1.0 -q tactiletestsrc num-buffers=600 ! video/x-raw,width=160,height=120,framerate=1/1 ! jpegenc ! matroskamux ! filesink location={film}".split(), check=True)
    set_chair("driver=simulator")
    app = App(film)
    app.find("label", "film.mkv")
    app.click("button", "Play it on the chair")
    app.find("label", "The chair plays film.mkv.")
    app.click("button", "Stop the film")
    app.find("label", "The chair waits.")
    assert not app.has("visuotactile-play")
    app.quit()


def names_controls():
    """Whatever the keyboard reaches, on each page, has a name for a screen reader."""
    tools = work / "bin"
    tools.mkdir(exist_ok=True)
    for name in ("mpv", "kodi", "totem"):
        (tools / name).write_text("#!/bin/sh\n", encoding="utf-8")
        (tools / name).chmod(0o755)
    set_chair("driver=intiface", "grid=2x2")  # with the field of Intiface's devices
    app = App(PATH=f"{tools}:{os.path.dirname(os.environ['APP'])}:{os.environ['PATH']}")
    app.find("check box", "Totem")
    app.find("button", "No hardware")
    controls = app.controls()
    assert len(controls) > 25, controls
    unnamed = [(before, role) for (_, before), (role, name) in zip([("", "")] + controls, controls) if not name.strip() or name.startswith("Gtk")]  # a type instead
    assert not unnamed, f"without a name, after which one: {unnamed}"
    app.quit()


def speaks_german():
    app = App(LC_ALL="C.UTF-8", LANGUAGE="de")
    app.find("button", "Motoren fühlen")
    app.find("", "Vibration ausschalten")
    english = [node.get_name() for node in app.all() if (node.get_name() or "").startswith(("The ", "No ", "Switch "))]
    assert not english, english
    app.quit()


def feels_a_vest():
    """From the start of the window to a film that is felt on a vest: three decisions, no terminal. Prints the time."""
    server = start(sys.executable, os.environ["SERVER"], "bhaptics", "port=15881", stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert server.stdout.readline().split()[-1] == "15881"
    begin = time.monotonic()
    app = App()
    app.find("button", "Vest of bHaptics, back")
    tab_to(app, "button", "Vest of bHaptics, back")
    app.key("space")  # 1: the device
    wait_until("the device", lambda: "device=vest-back" in settings())
    app.key("ctrl+2")  # 2: the page of films
    app.click("button", "Play an example")  # 3
    while not (line := server.stdout.readline()).startswith("motors") or "=" not in line:
        assert line, "the server has ended"
    print(f"felt after {time.monotonic() - begin:.0f} s and 3 decisions")
    app.quit()


TESTS = {test.__name__: test for test in (finds_devices, chooses_by_keys, tests_what_was_chosen, feels_motors, switches_all_off, switches_players, plays_a_film, names_controls, speaks_german, feels_a_vest)}
for chosen in sys.argv[1:] or TESTS:
    CHAIR.unlink(missing_ok=True)
    TESTS[chosen]()
    print(chosen, flush=True)
