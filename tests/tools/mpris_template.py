# SPDX-License-Identifier: LGPL-2.1-or-later
"""A player for python3-dbusmock. Its film began at `begin` of CLOCK_MONOTONIC and goes by `clock` seconds a second; where it is is renewed each `renewed` s, up to `jitter` s later, and rounded down to `rounded` s. With `second`, that many are a second, and numbers are doubles."""

import random
import time

import dbus
from gi.repository import GLib

BUS_NAME = "org.mpris.MediaPlayer2.mock"
MAIN_OBJ = "/org/mpris/MediaPlayer2"
MAIN_IFACE = "org.mpris.MediaPlayer2.Player"
SYSTEM_BUS = False


def load(mock, parameters):
    begin, clock, renewed, jitter, rounded = (float(parameters[name]) for name in ("begin", "clock", "renewed", "jitter", "rounded"))
    mock.AddProperties(MAIN_IFACE, {"PlaybackStatus": "Playing", "Rate": 1.0, "Position": dbus.Int64(0),
                                    "Metadata": dbus.Dictionary({"xesam:url": parameters["film"]}, signature="sv")})
    chance = random.Random(1)

    def renew():
        position = (time.monotonic() - begin) * clock
        position -= position % rounded
        mock.props[MAIN_IFACE]["Position"] = dbus.Double(position * float(parameters["second"])) if "second" in parameters else dbus.Int64(round(position * 1e6))
        GLib.timeout_add(round(1000 * (renewed + chance.uniform(0, jitter))), renew)
        return False

    renew()
