# SPDX-License-Identifier: LGPL-2.1-or-later
"""Real players: each plays, pauses, seeks and changes its rate at once when it is told to, and says when it was told. They are heard at `stage.sound`, a
NullSink.

Root starts them as nobody, since VLC does not run as root, on a session bus of their own."""

import atexit
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

import gi

gi.require_version("Gio", "2.0")
from gi.repository import Gio, GLib  # noqa: E402
from mpv_socket import MpvSocket  # noqa: E402

signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended by SIGTERM"))  # so that the players are ended, too
NOBODY = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
BUS = """<busconfig><type>session</type><listen>unix:tmpdir=/tmp</listen><auth>EXTERNAL</auth>
<policy context="default"><allow user="*"/><allow own="*"/><allow send_destination="*" eavesdrop="true"/><allow eavesdrop="true"/></policy></busconfig>"""


LATEST = 60  # s: until something that has to happen has failed to


def wait_until(what, is_true, latest=LATEST):
    end = time.monotonic() + latest
    while not is_true():
        assert time.monotonic() < end, f"waited {latest} s in vain for {what}"
        time.sleep(0.005)


class Bus:
    def __init__(self, folder):
        config = folder / "bus.conf"
        config.write_text(BUS, encoding="utf-8")
        self.process = subprocess.Popen(["dbus-daemon", f"--config-file={config}", "--nofork", "--print-address"], stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()

    def stop(self):
        self.process.kill()
        self.process.wait()

    def connection(self):
        flags = Gio.DBusConnectionFlags
        return Gio.DBusConnection.new_for_address_sync(self.address, flags.AUTHENTICATION_CLIENT | flags.MESSAGE_BUS_CONNECTION, None, None)


class Player:
    """`how` are the options that make visuotactile-follow follow it, `name` is what it calls it, `film` what it calls its film, which is in `file`."""

    file = film = "film.mkv"

    def __init__(self, words, stage, **environment):
        home = stage.folder / self.kind
        home.mkdir(exist_ok=True)
        if NOBODY:
            os.chown(home, NOBODY["user"], NOBODY["group"])
        self.home = home
        self.prepare(stage)
        env = dict(os.environ, HOME=str(home), XDG_RUNTIME_DIR=str(home), DISPLAY=stage.screen.name,
                   DBUS_SESSION_BUS_ADDRESS=stage.bus.address, PULSE_SERVER=f"unix:{stage.sound.socket}", **environment)
        for name in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "WAYLAND_DISPLAY"):
            env.pop(name, None)
        self.said = open(stage.folder / f"{self.kind}.log", "ab")
        self.process = subprocess.Popen(words, env=env, cwd=home, stdin=subprocess.DEVNULL, stdout=self.said, stderr=subprocess.STDOUT,
                                        start_new_session=True, **NOBODY)
        atexit.register(self.kill)

    def prepare(self, stage):
        pass

    def is_alive(self):
        return self.process.poll() is None

    def hang(self):
        os.killpg(self.process.pid, signal.SIGSTOP)
        return time.monotonic()

    def go_on(self):
        os.killpg(self.process.pid, signal.SIGCONT)

    def kill(self):
        if self.is_alive():
            os.killpg(self.process.pid, signal.SIGKILL)
        at = time.monotonic()
        self.process.wait()
        self.said.close()
        return at


class Mpv(Player):
    kind = "mpv"

    def __init__(self, film, stage):
        self.path = str(stage.folder / self.kind / "mpv.sock")
        super().__init__(["mpv", "--no-config", "--vo=x11", "--ao=pulse", "--fullscreen", "--pause", "--no-osc", f"--input-ipc-server={self.path}", str(film)], stage)
        self.socket = MpvSocket(self.path)
        wait_until("mpv's socket", self.socket.connects)
        self.how, self.name = [f"--mpv={self.path}"], f"mpv at {self.path}"

    def _command(self, *words):
        self.socket.command(*words)
        return time.monotonic()

    def play(self):
        return self._command("set_property", "pause", False)

    def pause(self):
        return self._command("set_property", "pause", True)

    def seek(self, by):
        return self._command("seek", by, "relative", "exact")

    def rate(self, rate):
        return self._command("set_property", "speed", rate)

    def load(self, film):
        return self._command("loadfile", str(film))


class Vlc(Player):
    kind = "vlc"
    file = film = "film.ts"  # whose 0:00 it shows as 0.7 s
    bus_name, path = "org.mpris.MediaPlayer2.vlc", "/org/mpris/MediaPlayer2"

    def __init__(self, film, stage):
        super().__init__(["vlc", "-I", "dummy", "--aout=pulse", "--vout=xcb_x11", "--fullscreen", "--no-video-title-show", "--no-spu", "--no-osd",
                          "--start-paused", film.as_uri()], stage)
        self.bus = stage.bus.connection()
        wait_until("VLC on the bus", self._is_paused)
        self.how, self.name = ["--mpris=vlc"], "vlc"

    def _is_paused(self):
        assert self.is_alive(), "VLC has ended"
        try:
            return self._call("org.freedesktop.DBus.Properties", "Get", "(ss)", self._player, "PlaybackStatus")[0] == "Paused"
        except GLib.Error:
            return False

    _player = "org.mpris.MediaPlayer2.Player"

    def _call(self, interface, method, types=None, *arguments):
        return self.bus.call_sync(self.bus_name, self.path, interface, method, GLib.Variant(types, arguments) if types else None, None,
                                  Gio.DBusCallFlags.NO_AUTO_START, 10000, None).unpack()

    def _do(self, *call):
        at = time.monotonic()
        self._call(*call)
        return at

    def play(self):
        return self._do(self._player, "Play")

    def pause(self):
        return self._do(self._player, "Pause")

    def seek(self, by):
        return self._do(self._player, "Seek", "(x)", round(by * 1e6))

    def rate(self, rate):
        return self._do("org.freedesktop.DBus.Properties", "Set", "(ssv)", self._player, "Rate", GLib.Variant("d", rate))


class Kodi(Player):
    """Its port is one of its own, in case somebody watches a film here."""

    kind = "kodi"

    def __init__(self, film, stage):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            self.port = unused.getsockname()[1]
        super().__init__(["kodi", "--windowing=x11", "--gl-interface=glx", "--audio-backend=pulseaudio"], stage, LIBGL_ALWAYS_SOFTWARE="1")
        self.line, self.id, self.bytes = socket.socket(), 0, ""
        wait_until("Kodi's port", self._connects)
        self.how, self.name = [f"--kodi=127.0.0.1:{self.port}"], "kodi"
        wait_until("Kodi", lambda: self._call("JSONRPC.Ping") == "pong")
        self._call("Player.Open", item={"file": str(film)})
        wait_until("the film", lambda: self._call("Player.GetActivePlayers"))
        wait_until("a film that pauses", self._pauses)  # an active player can still be about to open it

    def _pauses(self):
        try:
            return self.pause()
        except AssertionError:
            return None

    def prepare(self, stage):
        data = self.home / ".kodi" / "userdata"
        data.mkdir(parents=True, exist_ok=True)
        (data / "advancedsettings.xml").write_text(
            f"<advancedsettings version='1.0'><jsonrpc><tcpport>{self.port}</tcpport></jsonrpc></advancedsettings>", encoding="utf-8")
        if NOBODY:
            for folder in (data.parent, data):
                os.chown(folder, NOBODY["user"], NOBODY["group"])

    def _connects(self):
        assert self.is_alive(), "Kodi has ended"
        try:
            self.line.connect(("127.0.0.1", self.port))
        except OSError:
            self.line.close()
            self.line = socket.socket()
            return False
        return True

    def _call(self, method, **parameters):
        """What is said meanwhile is left out. Nothing lies between objects."""
        self.id += 1
        self.line.sendall(json.dumps({"jsonrpc": "2.0", "id": self.id, "method": method, "params": parameters}).encode())
        while True:
            try:
                told, end = json.JSONDecoder().raw_decode(self.bytes)
            except json.JSONDecodeError:
                got = self.line.recv(65536).decode()
                assert got, "Kodi has closed the connection"
                self.bytes += got
                continue
            self.bytes = self.bytes[end:].lstrip()
            if told.get("id") == self.id:
                assert "result" in told, told
                return told["result"]

    def _do(self, method, **parameters):
        at = time.monotonic()
        self._call(method, playerid=1, **parameters)
        return at

    def play(self):
        return self._do("Player.PlayPause", play=True)

    def pause(self):
        return self._do("Player.PlayPause", play=False)

    def seek(self, by):
        return self._do("Player.Seek", value={"seconds": round(by)})

    def rate(self, rate):
        return self._do("Player.SetSpeed", speed=rate)


class Chromium(Player):
    """A page that is a film. It is told to the bus once it has played."""

    kind, film, extension, page = "chromium", "film", None, None
    options = ("--no-sandbox --no-first-run --disable-background-networking --disable-component-update --disable-sync --disable-gpu --kiosk "
               "--autoplay-policy=no-user-gesture-required --remote-debugging-port=0")

    def __init__(self, film, stage):
        page = film.with_suffix(".html")
        page.write_text(f"""<!DOCTYPE html><title>{self.film}</title><style>body {{ margin: 0; overflow: hidden }} video {{ width: 100vw; height: 100vh }}</style>
<video src="{film.name}"></video>""", encoding="utf-8")
        page.chmod(0o644)
        profile = stage.folder / self.kind / "profile"
        extended = [f"--load-extension={shutil.copytree(self.extension, stage.folder / 'extension')}"] if self.extension else []
        super().__init__(["chromium", *self.options.split(), *extended, f"--user-data-dir={profile}", "about:blank"], stage)
        from selenium import webdriver  # other players do without it
        from selenium.webdriver.chrome.options import Options
        from selenium.webdriver.chrome.service import Service

        port = profile / "DevToolsActivePort"
        wait_until("Chromium's port", lambda: port.exists() and port.read_text(encoding="utf-8").count("\n") > 0)
        options = Options()
        options.debugger_address = f"127.0.0.1:{port.read_text(encoding='utf-8').splitlines()[0]}"
        self.page = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.page.get(page.as_uri())
        wait_until("the film", lambda: self._does("return film.readyState == 4"))
        self.play()
        bus = stage.bus.connection()
        wait_until("Chromium on the bus", lambda: self._names(bus))
        self.name = self._names(bus)[0]
        self.how = [f"--mpris={self.name}", f"--tracks={stage.folder}"]
        self.pause()
        self._does("film.currentTime = 0")

    def _names(self, bus):
        assert self.is_alive(), "Chromium has ended"
        prefix = "org.mpris.MediaPlayer2."
        names, = bus.call_sync("org.freedesktop.DBus", "/", "org.freedesktop.DBus", "ListNames", None, None, Gio.DBusCallFlags.NONE, 10000, None).unpack()
        return [name.removeprefix(prefix) for name in names if name.startswith(prefix + self.kind)]

    def _does(self, script):
        return self.page.execute_script(f"const film = document.querySelector('video'); {script}")

    def _do(self, script):
        at = time.monotonic()
        self._does(script)
        return at

    def play(self):
        return self._do("film.play()")

    def pause(self):
        return self._do("film.pause()")

    def seek(self, by):
        return self._do(f"film.currentTime += {by}")

    def rate(self, rate):
        return self._do(f"film.playbackRate = {rate}")

    def kill(self):
        at = super().kill()
        if self.page:
            self.page.service.stop()
        return at


class ExtendedChromium(Chromium):
    extension = pathlib.Path(__file__).resolve().parents[2] / "examples/chromium"


PLAYERS = {"mpv": Mpv, "vlc": Vlc, "kodi": Kodi, "chromium": Chromium, "chromium-extended": ExtendedChromium}
