#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A process that lists devices and plays on boards has not loaded what gamepads and servers need, neither by itself nor by another library.
One that plays on a gamepad or by a server has.

Usage: loaded_libraries.py [gamepad] [websocket]: the modules that were built
"""
import pathlib
import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

# What each module is loaded for; no player has them from elsewhere.
LIBRARIES = {"gamepad": ["libSDL2-2.0"], "websocket": ["libsoup-3.0", "libjson-glib-1.0"]}
# Without a gamepad or a server these fail, but only after their module was loaded.
DRIVERS = {"gamepad": "driver=gamepad", "websocket": "driver=bhaptics device=vest@127.0.0.1:1"}


def loaded(library: str) -> bool:
    """Whether the library's file is mapped into this process."""
    return f"/{library}." in pathlib.Path("/proc/self/maps").read_text(encoding="utf-8")


def expect_none(when: str) -> None:
    """Ends the test if any of the libraries is there."""
    for libraries in LIBRARIES.values():
        for library in libraries:
            if loaded(library):
                sys.exit(f"{library} is loaded {when}")


def play(driver: str) -> Gst.MessageType:
    """Plays a short film. Returns how it ended."""
    pipeline = Gst.parse_launch(
        f"tactiletestsrc num-buffers=5 ! video/x-raw,width=64,height=64 ! saliencytactile ! tactorsink sync=false {driver}"
    )
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(Gst.CLOCK_TIME_NONE, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    return message.type


def main() -> None:
    """Runs the test."""
    Gst.init(None)
    expect_none("before anything plays")
    provider = Gst.DeviceProviderFactory.get_by_name("tactordeviceprovider")
    if not provider.start():
        sys.exit("tactordeviceprovider does not start")
    provider.get_devices()
    provider.stop()
    expect_none("after devices were listed")
    for driver in ("simulator", "auto", "firmata", "seat"):  # the last two without a board
        ended = play(f"driver={driver}")
        if driver in ("simulator", "auto") and ended != Gst.MessageType.EOS:
            sys.exit(f"driver={driver} does not play")
        expect_none(f"after a play with driver={driver}")
    for module in sys.argv[1:]:
        play(DRIVERS[module])
        for library in LIBRARIES[module]:
            if not loaded(library):
                sys.exit(f"{library} is not loaded by a play with {DRIVERS[module]}: what this test looks for is not what is used")


if __name__ == "__main__":
    main()
