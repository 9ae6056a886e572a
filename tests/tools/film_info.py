#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Prints a film's duration in seconds, width, height and kinds of streams: "1.000 320 240 video audio". Status 1 if it is incomplete."""
import os
import sys
import urllib.parse

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstPbutils", "1.0")
from gi.repository import GLib, Gst, GstPbutils  # noqa: E402

Gst.init(None)
try:
    uri = "file://" + urllib.parse.quote(os.fsencode(os.path.abspath(sys.argv[1])))
    info = GstPbutils.Discoverer.new(20 * Gst.SECOND).discover_uri(uri)
except GLib.Error as error:
    sys.exit(f"{sys.argv[1]!r}: {error.message}")
videos = info.get_video_streams()
# A recording that was not finished has no duration.
if not videos or info.get_duration() in (0, Gst.CLOCK_TIME_NONE):
    sys.exit(f"{sys.argv[1]!r}: no picture or no duration")
print(f"{info.get_duration() / Gst.SECOND:.3f}", videos[0].get_width(), videos[0].get_height(), "video",
      *(["audio"] if info.get_audio_streams() else []))
