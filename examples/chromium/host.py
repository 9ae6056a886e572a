#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the extension cannot do: it asks visuotactile-follow for the film that plays, and makes a track of a file that the user chooses.

host.py --install [FOLDER]    tells Chromium, whose settings are in FOLDER (~/.config/chromium), of this program
"""
import contextlib
import json
import os
import pathlib
import pty
import re
import shutil
import struct
import subprocess
import sys

from gi.repository import Gio, GLib

NAME = "org.visuotactile.offer"
EXTENSION = "ddinakopmecoeaaeikdpmgdloigpggep"  # by the key in manifest.json
FOLLOW = "org.visuotactile.Follow1"
MOST = 1 << 16  # bytes of a message
LONGEST = 200  # bytes of a name
CHOOSERS = (["zenity", "--file-selection", "--title=The film's file"], ["kdialog", "--title", "The film's file", "--getopenfilename", "."])


def install(folder):
    place = pathlib.Path(folder) / "NativeMessagingHosts" / f"{NAME}.json"
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(json.dumps({"name": NAME, "description": "Tracks of films for the chair", "path": str(pathlib.Path(__file__).resolve()), "type": "stdio",
                                 "allowed_origins": [f"chrome-extension://{EXTENSION}/"]}, indent=2) + "\n", encoding="utf-8")
    print(place)


def receive():
    """The next message; None at the end."""
    head = sys.stdin.buffer.read(4)
    if len(head) < 4:
        return None
    size, = struct.unpack("=I", head)
    return json.loads(sys.stdin.buffer.read(size)) if size <= MOST else None


def send(message):
    text = json.dumps(message).encode()
    sys.stdout.buffer.write(struct.pack("=I", len(text)) + text)
    sys.stdout.buffer.flush()


def status():
    """Of the film that plays; starts no follower."""
    try:
        bus = Gio.bus_get_sync(Gio.BusType.SESSION, None)
        answer = bus.call_sync(FOLLOW, "/org/visuotactile/Follow1", "org.freedesktop.DBus.Properties", "GetAll", GLib.Variant("(s)", (FOLLOW,)),
                               GLib.VariantType("(a{sv})"), Gio.DBusCallFlags.NO_AUTO_START, 5000, None)
    except GLib.Error:
        return {"runs": False}
    found, = answer.unpack()
    return {"runs": True} | {name: found.get(name.capitalize(), "") for name in ("film", "track", "fault", "library")}


def choose():
    chooser = next((words for words in CHOOSERS if shutil.which(words[0])), None)
    if chooser is None:
        raise RuntimeError("There is no program to choose a file: install zenity or kdialog.")
    return os.fsdecode(subprocess.run(chooser, stdout=subprocess.PIPE, check=False).stdout).rstrip("\n")


def author(file, track, told):
    """The exit status of tactile-track author and its last line. It shows its progress on a terminal, of which `told` gets each percentage."""
    own, its = pty.openpty()
    with subprocess.Popen(["tactile-track", "author", file, "-o", str(track)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=its) as process:
        os.close(its)
        line = shown = ""
        with contextlib.suppress(OSError):  # the end of a terminal
            while piece := os.read(own, 4096):
                line = re.split(r"[\r\n]+(?:\x1b\[K)?(?=.)", line + piece.decode(errors="replace"))[-1][-MOST:]
                share = re.match(r"\d+ %", line)
                if share and share[0] != shown:
                    shown = share[0]
                    told(shown)
    os.close(own)
    return process.returncode, line.replace("\x1b[K", "").strip()


def make(shown):
    """The track of the film that the button showed."""
    now = status()
    film, folder = now.get("film", ""), pathlib.Path(now.get("library", ""))
    if not film or not folder.is_absolute() or not folder.is_dir():
        raise RuntimeError("No film plays, or visuotactile-follow has no folder of tracks.")
    if film != shown:
        raise RuntimeError(f"Another film plays now: “{film}”.")
    track = folder / f"{film}.vtt"
    if film.startswith(".") or "/" in film or not film.isprintable() or len(track.name.encode()) > LONGEST:
        raise RuntimeError("The film's title is no name for a file.")
    if track.exists():
        raise RuntimeError(f"“{track}” exists already.")
    file = choose()
    if not file:
        return "No file was chosen."
    send({"text": f"A track of “{file}” is being made …", "badge": "…"})
    end, complaint = author(file, track, lambda share: send({"text": f"A track of “{file}” is being made: {share}", "badge": "…"}))
    if end != 0:
        raise RuntimeError(f"No track was made: {complaint or 'tactile-track failed'}")
    return f"“{film}” has a track now: {track}"


def main():
    if sys.argv[1:2] == ["--install"]:
        install(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path.home() / ".config/chromium")
        return
    while (message := receive()) is not None:
        try:
            send(status() if message.get("ask") == "status" else {"text": make(message.get("film")), "badge": ""})
        except (OSError, RuntimeError) as error:
            send({"text": str(error), "badge": "!"})


main()
