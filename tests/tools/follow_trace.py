# SPDX-License-Identifier: LGPL-2.1-or-later
"""A track of pulses, and when they are felt by the trace of visuotactile-follow."""

import csv


def make_track(path, pulses, end):
    """`pulses` are (second, how long), of one tactor."""
    rows = ["# tactile grid=1x1 rate=5", "time_ms,t0"]
    for second, lasts in pulses:
        rows += [f"{second * 1000},1", f"{1000 * (second + lasts):.0f},0"]
    path.write_text("\n".join(rows + [f"{end * 1000},0"]) + "\n", encoding="utf-8")


def read_trace(path):
    """(issued, effect, volts) in seconds of CLOCK_MONOTONIC; the last line may be written still."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    return [(int(row["issued_ns"]) / 1e9, int(row["effect_ns"]) / 1e9, float(row["volts"])) for row in csv.DictReader(lines[:-1])]


def onsets(rows):
    """When a pulse is felt in full."""
    found, on = [], False
    for _, effect, volts in rows:
        if volts > 2.9 and not on:
            found.append(effect)
        on = volts > 0 and (on or volts > 2.9)
    return found
