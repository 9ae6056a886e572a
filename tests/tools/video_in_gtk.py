#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A window of GTK 4 with a GtkVideo: video_in_gtk.py FILM"""
import sys

import gi

gi.require_version("Gtk", "4.0")
from gi.repository import Gtk  # noqa: E402


def show(application):
    video = Gtk.Video.new_for_filename(sys.argv[1])
    video.set_autoplay(True)
    window = Gtk.ApplicationWindow(application=application, child=video)
    window.present()


application = Gtk.Application()
application.connect("activate", show)
application.run([])
