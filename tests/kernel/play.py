#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plays a chair with the first MOTORS of nine fully on, until a word on standard input: null, eos, pause, exec, _exit, abort, or end of file.

Usage: play.py MOTORS DRIVER [DEVICE]    $TACTORSINK are further properties of tactorsink. Prints each message of tactorsink, "playing" when it plays, "done" after the word."""
import os
import struct
import sys
import threading
import time

import gi
gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

motors, driver = int(sys.argv[1]), sys.argv[2]
Gst.init(None)
pipeline = Gst.parse_launch('appsrc name=maps format=time is-live=true do-timestamp=true '
                            'caps="application/x-tactile-map,rows=(int)3,columns=(int)3,framerate=(fraction)25/1" ! '
                            f'tactorsink name=tactors driver={driver} max-active=0 max-duty=0 max-on-time=0 {os.environ.get("TACTORSINK", "")}')
if len(sys.argv) > 3:
    pipeline.get_by_name("tactors").set_property("device", sys.argv[3])


def tell(_, message):
    if message.type in (Gst.MessageType.ERROR, Gst.MessageType.WARNING, Gst.MessageType.INFO):
        kind = message.type.first_value_nick
        error, _ = getattr(message, "parse_" + kind)()
        print(kind, error.message, flush=True)
    elif message.type == Gst.MessageType.ELEMENT:
        print("element", message.get_structure().to_string(), flush=True)
    return Gst.BusSyncReply.PASS


def feed():
    while True:
        buffer = Gst.Buffer.new_wrapped(struct.pack("<9f", *[1.0 if i < motors else 0.0 for i in range(9)]))
        buffer.duration = 40 * Gst.MSECOND
        if pipeline.get_by_name("maps").emit("push-buffer", buffer) != Gst.FlowReturn.OK:
            return
        time.sleep(0.04)


def until_told():
    return sys.stdin.readline().strip()


pipeline.get_bus().set_sync_handler(tell)
threading.Thread(target=feed, daemon=True).start()
# The board is opened in the background. The sink gets its first frame when it is open.
if (pipeline.set_state(Gst.State.PLAYING) == Gst.StateChangeReturn.FAILURE
        or pipeline.get_by_name("tactors").get_state(Gst.CLOCK_TIME_NONE)[0] == Gst.StateChangeReturn.FAILURE):
    print("failed", flush=True)
    sys.exit(1)
print("playing", flush=True)
word = until_told()
if word == "null":
    pipeline.set_state(Gst.State.NULL)
elif word == "pause":
    pipeline.set_state(Gst.State.PAUSED)
elif word == "eos":
    pipeline.send_event(Gst.Event.new_eos())
    pipeline.get_bus().timed_pop_filtered(Gst.CLOCK_TIME_NONE, Gst.MessageType.EOS)
    pipeline.set_state(Gst.State.NULL)
elif word == "exec":
    os.execv("/bin/true", ["true"])
elif word == "_exit":
    os._exit(0)
elif word == "abort":
    os.abort()
print("done", flush=True)
until_told()
