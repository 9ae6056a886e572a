#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plays a film and draws its tactile maps in the terminal, in real time.

Usage: terminal.py FILM
"""
import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstTactile", "1.0")
from gi.repository import GLib, Gst, GstTactile  # noqa: E402

SHADES = " ░▒▓█"


def draw(levels, columns):
    """Draws a map as rows of blocks, in place of the one before."""
    rows = [levels[i : i + columns] for i in range(0, len(levels), columns)]
    lines = ["".join(SHADES[round(level * (len(SHADES) - 1))] * 4 for level in row) for row in rows]
    home = f"\x1b[{len(lines)}A" if sys.stdout.isatty() else ""
    print("\n".join("|" + line + "|" for line in lines) + "\n" + home, end="", flush=True)
    return len(lines)


def on_map(sink):
    sample = sink.emit("pull-sample")
    _, rows, columns, _, _ = GstTactile.tactile_map_caps_parse(sample.get_caps())
    _, levels = GstTactile.tactile_map_buffer_get_levels(sample.get_buffer(), rows, columns)
    draw(levels, columns)
    return Gst.FlowReturn.OK


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip().rsplit("\n", 1)[-1])
    Gst.init(None)
    uri = sys.argv[1] if Gst.uri_is_valid(sys.argv[1]) else Gst.filename_to_uri(sys.argv[1])
    pipeline = Gst.parse_launch(
        "uridecodebin name=film film. ! queue ! videoconvert ! saliencytactile ! tactileextractor name=split "
        "split.tactile ! queue ! appsink name=maps emit-signals=true"
    )
    pipeline.get_by_name("film").set_property("uri", uri)
    pipeline.get_by_name("maps").connect("new-sample", on_map)

    loop = GLib.MainLoop()
    failed = []

    def on_message(_bus, message):
        if message.type == Gst.MessageType.ERROR:
            failed.append(message.parse_error()[0].message)
        if message.type in (Gst.MessageType.ERROR, Gst.MessageType.EOS):
            loop.quit()

    bus = pipeline.get_bus()
    bus.add_signal_watch()
    bus.connect("message", on_message)
    pipeline.set_state(Gst.State.PLAYING)
    try:
        loop.run()
    except KeyboardInterrupt:
        pass
    pipeline.set_state(Gst.State.NULL)
    sys.exit(failed[0] if failed else 0)


if __name__ == "__main__":
    main()
