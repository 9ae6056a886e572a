#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plays an RTSP stream with visuotactilesink: the latency covers network and motors, frames cause commands, and commands are on time.

GStreamer's RTSP server sends a live film in H.264 over RTP on loopback. The test ends once some commands were on time, whatever number a busy
machine delayed before. If the latency is not honored, none ever is. The test compares running times and prints how late commands were.

Usage: rtsp.py [PLAYBIN]...      (playbin and playbin3 if none is named; with the plugins on GST_PLUGIN_PATH)
"""
import contextlib
import csv
import os
import sys
import tempfile
import threading
import time

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstBase", "1.0")
gi.require_version("GstRtspServer", "1.0")
gi.require_version("GstTactile", "1.0")
from gi.repository import GLib, Gst, GstBase, GstRtspServer, GstTactile  # noqa: E402

FILM = (
    "( tactiletestsrc is-live=true pattern=dynamic-motion ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 "
    "! x264enc tune=zerolatency speed-preset=ultrafast key-int-max=15 ! rtph264pay name=pay0 )"
)
JITTER = 200  # ms
LEAD = 190  # ms: tactorsink's max-lead and 10 ms of margin
ON_TIME = 20  # commands
PATIENCE = 60  # s; a bound, not a measure
SAME = 1000  # ns
# Each map gives commands, without limits.
CHAIR = (
    "visuotactilesink driver=simulator rate=0 analysis::temporal=false tactors::ramp-in=0 tactors::max-active=0 tactors::max-duty=0 "
    "tactors::max-on-time=0 trace-location={} video-sink=fakesink"
)


def expect(condition, text):
    if not condition:
        raise SystemExit(f"FAILED: {text}")


@contextlib.contextmanager
def served(film):
    """The URI of a film that a server sends on request."""
    context = GLib.MainContext()
    loop = GLib.MainLoop.new(context, False)
    server = GstRtspServer.RTSPServer()
    server.set_address("127.0.0.1")
    server.set_service("0")  # any port
    factory = GstRtspServer.RTSPMediaFactory()
    factory.set_launch(film)
    factory.set_shared(True)
    server.get_mount_points().add_factory("/film", factory)
    expect(server.attach(context) > 0, "the server does not start")
    thread = threading.Thread(target=loop.run)
    thread.start()
    try:
        yield f"rtsp://127.0.0.1:{server.get_bound_port()}/film"
    finally:
        loop.quit()
        thread.join()


class Frames:
    """The running times of the frames that pass a pad, and which of their cells have a level."""

    def __init__(self, pad):
        self.felt = []
        pad.add_probe(Gst.PadProbeType.BUFFER, self.on_frame)

    def on_frame(self, pad, info):
        frame = info.get_buffer()
        segment = pad.get_sticky_event(Gst.EventType.SEGMENT, 0).parse_segment()
        meta = GstTactile.buffer_get_tactile_meta(frame)
        cells = [meta.get_level(row, column) > 0 for row in range(meta.rows) for column in range(meta.columns)] if meta else []
        self.felt.append((segment.to_running_time(Gst.Format.TIME, frame.pts), cells))
        return Gst.PadProbeReturn.OK


def play(playbin, uri, trace):
    """Plays until enough commands were on time. Returns analyzed and shown frames, and the latencies of pipeline and sinks."""
    player = Gst.ElementFactory.make(playbin)
    chair = Gst.parse_launch(CHAIR.format(trace))
    player.set_property("uri", uri)
    player.set_property("video-sink", chair)
    player.connect("source-setup", lambda _, source: source.set_property("latency", JITTER))
    screen = chair.get_property("video-sink")
    screen.set_property("sync", True)
    analyzed = Frames(chair.get_by_name("analysis").get_static_pad("src"))
    shown = Frames(screen.get_static_pad("sink"))

    def stats():
        values = chair.get_property("actuation-stats")
        return values.get_value("issued"), values.get_value("late")

    bus = player.get_bus()
    deadline = time.monotonic() + PATIENCE
    player.set_state(Gst.State.PLAYING)
    while True:
        expect(time.monotonic() < deadline, f"{playbin}: of {stats()[0]} commands {stats()[1]} were late, of {len(analyzed.felt)} frames {len(shown.felt)} shown")
        message = bus.timed_pop(20 * Gst.MSECOND)
        if message and message.type in (Gst.MessageType.ERROR, Gst.MessageType.EOS):
            raise SystemExit(f"FAILED: {playbin}: {message.parse_error() if message.type == Gst.MessageType.ERROR else 'the film ends'}")
        if message and message.type == Gst.MessageType.WARNING:
            expect("without touch" not in str(message.parse_warning()), f"{playbin}: {message.parse_warning()}")
        if message and message.type == Gst.MessageType.LATENCY:
            player.recalculate_latency()
        issued, late = stats()
        if issued - late >= ON_TIME and shown.felt:
            break

    query = Gst.Query.new_latency()
    expect(player.query(query), f"{playbin}: the latency query failed")
    sinks = [element for element in iterate(chair) if isinstance(element, GstBase.BaseSink)]
    latencies = {sink.get_latency() for sink in sinks}
    player.set_state(Gst.State.NULL)
    return analyzed.felt, shown.felt, query.parse_latency(), latencies, len(sinks)


def iterate(chair):
    elements = chair.iterate_recurse()
    while True:
        result, element = elements.next()
        if result != Gst.IteratorResult.OK:
            return
        yield element


def check(playbin, uri, work):
    trace = os.path.join(work, f"{playbin}.csv")
    analyzed, shown, (live, least, _), latencies, sinks = play(playbin, uri, trace)

    expect(live, f"{playbin}: the stream is not live")
    expect(least >= (JITTER + LEAD) * Gst.MSECOND, f"{playbin}: a latency of {least / 1e6:.0f} ms, less than {JITTER} for the network and {LEAD} for the motors")
    expect(sinks == 2 and latencies == {least}, f"{playbin}: the sinks wait {latencies}, the pipeline {least} ns")
    expect({running for running, _ in shown} <= {running for running, _ in analyzed}, f"{playbin}: frames are shown that were not analyzed")

    checked = 0
    late = []
    last = {}
    with open(trace, newline="", encoding="ascii") as file:
        for line in csv.DictReader(file):
            issued, due, effect = (int(line[f"{name}_ns"]) for name in ("issued", "due", "effect"))
            tactor, volts = int(line["tactor"]), float(line["volts"])
            last[tactor] = volts
            late.append(issued - due)
            if volts > 0:
                expect(
                    any(abs(running - effect) <= SAME and cells[tactor] for running, cells in analyzed if cells),
                    f"{playbin}: tactor {tactor} gets {volts} V at {effect} ns, but no frame then has this cell on",
                )
                checked += 1
    expect(checked > 0, f"{playbin}: no command turned a motor on")
    expect(not any(last.values()), f"{playbin}: motors are left on: {last}")
    late.sort()
    print(
        f"{playbin}: latency {least / 1e6:.0f} ms; {len(analyzed)} frames analyzed, {len(shown)} shown; {len(late)} commands, "
        f"{late[len(late) // 2] / 1e6:.2f} ms late (median), {late[-1] / 1e6:.2f} ms (most)"
    )


def main(playbins):
    Gst.init(None)
    with tempfile.TemporaryDirectory() as work, served(FILM) as uri:
        for playbin in playbins:
            check(playbin, uri, work)


if __name__ == "__main__":
    main(sys.argv[1:] or ["playbin", "playbin3"])
