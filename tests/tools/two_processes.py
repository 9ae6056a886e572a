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


def pass_on(sent, received):
    """From a sender's unixfdsink to a receiver, once the socket is there and listens."""
    sender = launch(sent.replace("SOCKET", "unixfdsink socket-path=socket wait-for-connection=true"))
    while launch(f"unixfdsrc socket-path=socket ! {received}").wait(90) != 0:
        assert sender.poll() is None, "the sender ended"
    assert sender.wait(90) == 0


# No tee before unixfdsink, whose frames are in memory that it proposes.
pass_on("tactiletestsrc num-buffers=100 ! video/x-raw,width=320,height=240 ! saliencytactile ! " + taken("here", "SOCKET"),
        taken("there", "fakesink") + " m. ! queue ! tactorsink driver=simulator sync=false trace-location=commands.csv")
here, there = (work / "here").read_bytes(), (work / "there").read_bytes()
assert len(here) == 100 * 9 * 4 and any(here), len(here)
assert here == there, (len(here), len(there))
assert len((work / "commands.csv").read_text(encoding="utf-8").splitlines()) > 10

# The frequency of a track on the frames.
(work / "track.vtt").write_text("WEBVTT\n\nNOTE tactile grid=1x2\n\n00:00.000 --> 00:00.500\n 50 0\n120 Hz\n\n00:00.500 --> 00:01.000\n 0 75\n",
                                encoding="utf-8")
pass_on("filesrc location=track.vtt ! subparse ! tactileconverter ! queue ! c.tactile "
        "tactiletestsrc num-buffers=30 ! video/x-raw,width=320,height=240 ! tactilecombiner name=c ! SOCKET",
        "tactileextractor name=x x.src ! queue ! fakesink sync=false x.tactile ! tactileconverter ! text/x-raw ! filesink location=cues")
cues = (work / "cues").read_text(encoding="utf-8")
assert cues.count("120 Hz") > 0 and " 75" in cues.rsplit("120 Hz", 1)[1], cues
