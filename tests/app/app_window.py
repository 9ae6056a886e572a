# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window of visuotactile as a screen reader finds it: an Xvfb, a session bus, AT-SPI, and a home folder of its own.

Expects the program APP, beside the programs that it runs, and the plugins on GST_PLUGIN_PATH."""

import atexit
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-app-"))
processes = []


def leave():
    for process in reversed(processes):
        process.terminate()
        process.wait()
    shutil.rmtree(work, ignore_errors=True)


atexit.register(leave)


def start(*arguments, **more):
    process = subprocess.Popen([str(argument) for argument in arguments], **more)
    processes.append(process)
    return process


def first_line(*arguments):
    """Starts a server that prints its address in one line."""
    return start(*arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout.readline().strip()


os.environ.update(HOME=str(work), XDG_CONFIG_HOME=str(work / "config"), XDG_STATE_HOME=str(work / "state"), XDG_CACHE_HOME=str(work / "cache"), XDG_RUNTIME_DIR=str(work),
                  GDK_BACKEND="x11", LIBGL_ALWAYS_SOFTWARE="1", NO_AT_BRIDGE="0")
os.environ.setdefault("SCREEN", "1366x768x24")
os.environ["DISPLAY"] = ":" + first_line("Xvfb", "-displayfd", "1", "-noreset", "-screen", "0", os.environ["SCREEN"], "-nolisten", "tcp")
os.environ["DBUS_SESSION_BUS_ADDRESS"] = first_line("dbus-daemon", "--session", "--print-address", "--nofork")

import gi  # noqa: E402

gi.require_version("Atspi", "2.0")
from gi.repository import Atspi, GLib  # noqa: E402

PATIENCE = 100  # s


def wait_until(what, condition):
    """The value of the condition, when it holds."""
    end = time.monotonic() + PATIENCE
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < end, f"waited in vain for {what}"
        GLib.MainContext.default().iteration(False)
        time.sleep(0.02)


class App:
    """The running window."""

    def __init__(self, *arguments, **environment):
        self.process = start(os.environ["APP"], *arguments, env=dict(os.environ, **environment))
        self.root = wait_until("the window", self._root)

    def _root(self):
        assert self.process.poll() is None, "the window's program has ended"
        desktop = Atspi.get_desktop(0)
        for index in range(desktop.get_child_count()):
            child = desktop.get_child_at_index(index)
            if child and child.get_process_id() == self.process.pid and child.get_child_count():
                return child
        return None

    def all(self):
        """All accessibles, in the order of the window, up to a part that goes away meanwhile."""

        def visit(node):
            node.clear_cache()
            yield node
            for index in range(node.get_child_count()):
                child = node.get_child_at_index(index)
                if child:
                    yield from visit(child)

        try:
            yield from visit(self.root)
        except GLib.Error:
            return

    def controls(self):
        """Role and name of all that can have the focus, on each page; what scrolls gives it to what is inside."""
        nodes = [node for node in self.all() if node.get_state_set().contains(Atspi.StateType.FOCUSABLE) and node.get_role_name() != "scroll pane"]
        return [(node.get_role_name(), node.get_name() or "") for node in nodes]

    def find_now(self, role, name, states=()):
        """`role` may be a part of it: a button is a push button in AT-SPI 2.46, a button in 2.56."""
        def is_it(node):
            try:
                if name not in (node.get_name() or "") or role not in node.get_role_name():
                    return False
                state = node.get_state_set()
                return state.contains(Atspi.StateType.VISIBLE) and all(state.contains(each) for each in states)
            except GLib.Error:
                return False

        return next((node for node in self.all() if is_it(node)), None)

    def find(self, role, name, states=()):
        return wait_until(f"{role} '{name}'", lambda: self.find_now(role, name, states))

    def click(self, role, name):
        node = self.find(role, name, [Atspi.StateType.SENSITIVE])
        assert node.get_action_iface() and node.do_action(0), f"{role} '{name}' cannot be pressed by a screen reader"

    def has(self, name):
        """Whether a text is shown."""
        return self.find_now("label", name) is not None

    def key(self, keys):
        subprocess.run(["xdotool", "key", keys], check=True)

    def quit(self):
        self.process.terminate()
        self.process.wait()
        processes.remove(self.process)


def settings():
    """The user's settings as lines."""
    file = work / "config/visuotactile/chair.conf"
    return file.read_text(encoding="utf-8").split("\n") if file.exists() else []


def picture(file, width, height):
    """The top left of the screen as a PNG."""
    subprocess.run(["gst-launch-1.0", "-q", "ximagesrc", "show-pointer=false", f"endx={width - 1}", f"endy={height - 1}", "num-buffers=1", "!", "videoconvert", "!", "pngenc", "!", "filesink", f"location={file}"], check=True)
