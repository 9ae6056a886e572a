#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A window of WebKitGTK with a page that plays a film: video_in_page.py FILM"""
import pathlib
import sys

import gi

gi.require_version("Gtk", "3.0")
gi.require_version("WebKit2", "4.1")
from gi.repository import Gtk, WebKit2  # noqa: E402

film = pathlib.Path(sys.argv[1])
page = pathlib.Path("page.html").resolve()
page.write_text(f'<video src="{film.as_uri()}" autoplay muted></video>')
view = WebKit2.WebView()
view.get_settings().set_property("media-playback-requires-user-gesture", False)
view.get_settings().set_property("hardware-acceleration-policy", WebKit2.HardwareAccelerationPolicy.NEVER)
window = Gtk.Window()
window.add(view)
window.show_all()
view.load_uri(page.as_uri())
Gtk.main()
