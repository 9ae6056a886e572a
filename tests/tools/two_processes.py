#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Maps cross from one process to another: a film that one analyzes plays the same commands on the chair of both.
Environment: the plugins on GST_PLUGIN_PATH_1_0"""

import csv
import pathlib
import subprocess
import tempfile

work = pathlib.Path(tempfile.mkdtemp())


def launch(line):
    return subprocess.Popen(["gst-launch-1.0", "-q", *line.split()], cwd=work)


def commands(name):
    with open(work / name, encoding="utf-8") as file:
        return [(row["effect_ns"], row["tactor"], row["volts"]) for row in csv.DictReader(file)]


CHAIR = "tactorsink driver=simulator sync=false rate=0 trace-location="
# The queue keeps the order of both chairs independent; the receiver connects when the socket is there.
sender = launch(f"tactiletestsrc num-buffers=100 ! video/x-raw,width=320,height=240 ! saliencytactile ! tee name=t "
                f"t. ! queue ! {CHAIR}here.csv t. ! queue ! unixfdsink socket-path=socket sync=false wait-for-connection=true")
while not (work / "socket").exists():
    try:
        raise AssertionError(f"the sender ended with {sender.wait(0.05)}")
    except subprocess.TimeoutExpired:
        pass
receiver = launch(f"unixfdsrc socket-path=socket ! queue ! {CHAIR}there.csv")
assert receiver.wait(90) == 0 and sender.wait(90) == 0
here, there = commands("here.csv"), commands("there.csv")
assert len(here) > 20, here
assert here == there, (len(here), len(there), [pair for pair in zip(here, there) if pair[0] != pair[1]][:3])
