#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Maps cross from one process to another by unixfdsink and unixfdsrc: the maps of a film that one process analyzes are those that
the other one takes from the frames, and plays on its chair. Environment: the plugins on GST_PLUGIN_PATH_1_0"""

import pathlib
import subprocess
import tempfile

work = pathlib.Path(tempfile.mkdtemp())


def launch(line):
    return subprocess.Popen(["gst-launch-1.0", "-q", *line.split()], cwd=work)


def taken(name):
    """Takes the maps from the frames into a file."""
    return f"tactileextractor name=x x.src ! queue ! fakesink sync=false x.tactile ! tee name=m m. ! queue ! filesink location={name}"


sender = launch(f"tactiletestsrc num-buffers=100 ! video/x-raw,width=320,height=240 ! saliencytactile ! tee name=t "
                f"t. ! queue ! unixfdsink socket-path=socket sync=false wait-for-connection=true t. ! queue ! {taken('here')}")
while True:  # until the socket is there, and listens
    receiver = launch(f"unixfdsrc socket-path=socket ! {taken('there')} "
                      "m. ! queue ! tactorsink driver=simulator sync=false trace-location=commands.csv")
    if receiver.wait(90) == 0:
        break
    assert sender.poll() is None, "the sender ended"
assert sender.wait(90) == 0
here, there = (work / "here").read_bytes(), (work / "there").read_bytes()
assert len(here) == 100 * 9 * 4 and any(here), len(here)
assert here == there, (len(here), len(there))
assert len((work / "commands.csv").read_text(encoding="utf-8").splitlines()) > 10
