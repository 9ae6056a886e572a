#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A window of GTK 4 with a GtkVideo: video_in_gtk.py FILM

Does what lines of its standard input say: pause, play, seek SECONDS, open FILM, quit.
"""
import sys

import gi

gi.require_version("Gtk", "4.0")
from gi.repository import GLib, Gtk  # noqa: E402


def obey(channel, _condition, video):
    line = channel.readline()
    if not line:
        return False
    word, _, argument = line.strip().partition(" ")
    stream = video.get_media_stream()
    if word == "pause":
        stream.pause()
    elif word == "play":
        stream.play()
    elif word == "seek":
        stream.seek(int(float(argument) * 1_000_000))
    elif word == "open":
        video.set_filename(argument)
    elif word == "quit":
        application.quit()
    return True


def show(application):
    video = Gtk.Video.new_for_filename(sys.argv[1])
    video.set_autoplay(True)
    window = Gtk.ApplicationWindow(application=application, child=video)
    window.set_default_size(640, 400)
    window.present()
    GLib.io_add_watch(sys.stdin, GLib.PRIORITY_DEFAULT, GLib.IOCondition.IN | GLib.IOCondition.HUP, obey, video)


application = Gtk.Application()
application.connect("activate", show)
application.run([])
