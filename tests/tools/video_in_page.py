#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A window of WebKitGTK with a page that plays a film: video_in_page.py FILM [OTHER]

Does what lines of its standard input say to the first film: pause, play, seek SECONDS, rate RATE,
open FILM; and quit. OTHER plays beside it.
"""
import pathlib
import sys

import gi

gi.require_version("Gtk", "3.0")
gi.require_version("WebKit2", "4.1")
from gi.repository import GLib, Gtk, WebKit2  # noqa: E402


def obey(channel, _condition, view):
    line = channel.readline()
    if not line:
        return False
    word, _, argument = line.strip().partition(" ")
    if word == "quit":
        Gtk.main_quit()
        return False
    call = {"pause": "pause()", "play": "play()", "seek": f"currentTime = {argument}", "rate": f"playbackRate = {argument}", "open": f"src = '{pathlib.Path(argument).absolute().as_uri()}'"}[word]
    view.run_javascript(f"document.querySelector('video').{call}", None, None, None)
    return True


films = [pathlib.Path(film).resolve().as_uri() for film in sys.argv[1:]]
page = pathlib.Path("page.html").resolve()
page.write_text("".join(f'<video src="{film}" width={width} autoplay muted></video>' for film, width in zip(films, (640, 160))))
view = WebKit2.WebView()
view.get_settings().set_property("media-playback-requires-user-gesture", False)
view.get_settings().set_property("hardware-acceleration-policy", WebKit2.HardwareAccelerationPolicy.NEVER)
window = Gtk.Window()
window.set_default_size(700, 560)
window.add(view)
window.show_all()
view.load_uri(page.as_uri())
GLib.io_add_watch(sys.stdin, GLib.PRIORITY_DEFAULT, GLib.IOCondition.IN | GLib.IOCondition.HUP, obey, view)
Gtk.main()
