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


def taken(name, frames):
    """Takes the maps from the frames into a file."""
    return f"tactileextractor name=x x.src ! queue ! {frames} sync=false x.tactile ! tee name=m m. ! queue ! filesink location={name}"


# No tee before unixfdsink, whose frames are in memory that it proposes.
sender = launch("tactiletestsrc num-buffers=100 ! video/x-raw,width=320,height=240 ! saliencytactile ! "
                + taken("here", "unixfdsink socket-path=socket wait-for-connection=true"))
while True:  # until the socket is there, and listens
    receiver = launch(f"unixfdsrc socket-path=socket ! {taken('there', 'fakesink')} "
                      "m. ! queue ! tactorsink driver=simulator sync=false trace-location=commands.csv")
    if receiver.wait(90) == 0:
        break
    assert sender.poll() is None, "the sender ended"
assert sender.wait(90) == 0
here, there = (work / "here").read_bytes(), (work / "there").read_bytes()
assert len(here) == 100 * 9 * 4 and any(here), len(here)
assert here == there, (len(here), len(there))
assert len((work / "commands.csv").read_text(encoding="utf-8").splitlines()) > 10
