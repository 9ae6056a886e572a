#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How many answers about its clock a theatre's server gives on one core: by its CPU time, which other programs do not change.

Usage: answers.py
"""
import os
import pathlib
import socket
import struct
import subprocess
import sys
import time

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstNet", "1.0")
from gi.repository import GLib, Gst, GstNet  # noqa: E402

QUESTION = struct.pack(">QQ", 1, 2**64 - 1)
AT_ONCE = 50
SECONDS = 10
OFTEN = 100  # questions a second of a seat whose clock is not settled


def serve():
    Gst.init(None)
    provider = GstNet.NetTimeProvider.new(Gst.SystemClock.obtain(), "127.0.0.1", 0)
    print(provider.get_property("port"), flush=True)
    GLib.MainLoop().run()


def cpu(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    if sys.argv[1:] == ["serve"]:
        serve()
    with subprocess.Popen([sys.executable, __file__, "serve"], stdout=subprocess.PIPE, text=True) as server, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.connect(("127.0.0.1", int(server.stdout.readline())))
        line.settimeout(1)
        before, end, answers = cpu(server), time.monotonic() + SECONDS, 0
        while time.monotonic() < end:
            for _ in range(AT_ONCE):
                line.send(QUESTION)
            for _ in range(AT_ONCE):
                line.recv(64)
                answers += 1
        each = (cpu(server) - before) / answers
        server.kill()
    print(f"{1e6 * each:.1f} us of CPU an answer: one core answers {1 / each / OFTEN:.0f} seats that all ask {OFTEN} times a second")


main()
