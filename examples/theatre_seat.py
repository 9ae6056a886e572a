#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A seat of a theatre: plays the maps of theatre_server.py on the motors of one chair."""
import argparse
import contextlib
import random
import sys
import threading

import theatre
import theatre_clock
import theatre_seats
from theatre import GLib, Gst


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server", help="the server's address, for the clock")
    parser.add_argument("--group", metavar="ADDRESS", default="239.255.42.42", help="multicast group of the maps")
    parser.add_argument("--unicast", action="store_true", help="receive unicast packets at this seat's address on the interface that leads to the server")
    parser.add_argument("--port", type=int, default=theatre.PORT)
    parser.add_argument("--clock-port", type=int, default=theatre.CLOCK_PORT)
    parser.add_argument("--ptp", type=int, metavar="DOMAIN", help="follow the grandmaster of this PTP domain instead of the server's clock, as the server does")
    parser.add_argument("--latency", type=int, default=theatre.LATENCY, metavar="MS", help="as the server's")
    parser.add_argument("--jitter", type=int, default=150, metavar="MS", help="how long to wait for a packet; the sum with the motors' lead, 190 ms, is less than the latency")
    parser.add_argument("--chair", default="", help="properties of tactorsink, such as 'intensity=0.5'")
    return parser.parse_args(arguments)


class Maps:
    """A bin that receives the maps of one showing. `over` is called once, when packets of another showing arrive.

    An RTP session and its jitter buffer take a new showing, or the same one after a long silence, for reordering, and wait for packets
    in sequence; with three copies of each and jitter they may wait forever. So each showing has a session of its own.
    """

    def __init__(self, options, address, socket, clock, over):
        self.clock, self.over = clock, over
        self.start = self.newest = None
        self.bin = Gst.parse_bin_from_description(
            f'udpsrc name=maps address={address} port={options.port} close-socket=false caps="{theatre.CAPS}" ! rtp.recv_rtp_sink_0 '
            f"rtpbin name=rtp ntp-sync=true ntp-time-source=clock-time buffer-mode=none latency={options.jitter} rtpgstdepay name=depay",
            False,
        )
        # udpsrc would bind a group's port on all addresses and receive unicast packets, too.
        source, rtp, depay = (self.bin.get_by_name(name) for name in ("maps", "rtp", "depay"))
        source.set_property("socket", socket)
        self.bin.add_pad(Gst.GhostPad.new("src", depay.get_static_pad("src")))
        source.get_static_pad("src").add_probe(Gst.PadProbeType.BUFFER, self._choose)
        # No probation (RFC 3550, A.1): the source is known, and the first packet counts.
        rtp.emit("get-session", 0).set_property("probation", 0)
        rtp.connect("pad-added", lambda _rtp, pad: pad.link(depay.get_static_pad("sink")) if pad.get_name().startswith("recv_rtp_src") else None)

    def _choose(self, _pad, info):
        """Drops all but the server's packets of this showing."""
        times = theatre.times(info.get_buffer().extract_dup(0, theatre.HEADER))
        if not times or not self.over:
            return Gst.PadProbeReturn.DROP
        start, time = times
        if abs(time - (self.clock.get_time() << 32) // Gst.SECOND) > theatre.LONG_SILENCE:
            return Gst.PadProbeReturn.DROP  # else later packets would seem old
        if self.start is None:
            self.start, self.newest = start, time
        another = abs((start - self.start + 2**31) % 2**32 - 2**31) > theatre.SAME_START or time > self.newest + theatre.LONG_SILENCE
        if another and time > self.newest:
            over, self.over = self.over, None
            over()
        self.newest = max(self.newest, time)
        return Gst.PadProbeReturn.DROP if another else Gst.PadProbeReturn.OK


def make(options):
    """The pipeline, with the network's clock; running time is that clock's time."""
    follower = None if options.ptp is not None else theatre_clock.Follower(options.server, options.clock_port)
    while follower and not follower.settled.wait(10):
        print(f"waiting for the clock of {options.server}: {follower.offset.hindrance}", flush=True)
    clock = follower.clock if follower else theatre.ptp_clock(options.ptp)

    address = theatre.own_address(options.server) if options.unicast else options.group
    socket = theatre.bound_socket(address, options.port)
    # The server has applied the rate.
    chair = Gst.parse_launch(f"tactorsink name=chair rate=0 {options.chair}")
    pipeline = Gst.Pipeline.new()
    pipeline.add(chair)
    maps = None

    def hear():
        nonlocal maps
        if maps:
            maps.bin.set_state(Gst.State.NULL)
            pipeline.remove(maps.bin)
        maps = Maps(options, address, socket, clock, lambda: GLib.idle_add(hear))
        pipeline.add(maps.bin)
        maps.bin.link(chair)
        maps.bin.sync_state_with_parent()

    hear()
    if follower:
        # Silent without the clock: no touch is better than touch at the wrong time.
        mute = chair.get_property("mute")
        one_by_one = threading.Lock()

        def silence():
            with one_by_one:
                chair.set_property("mute", mute or not follower.settled.is_set())

        def on_change(settled):
            silence()
            with contextlib.suppress(OSError):  # nobody reads it
                print(f"the clock of {options.server} is {'synchronized again' if settled else 'lost: the chair is silent'}", flush=True)

        follower.on_change = on_change
        silence()
    number = random.getrandbits(32)
    line = theatre_seats.Line(options.server, options.clock_port + 1)

    def report():
        late = chair.get_property("actuation-stats").get_uint64("late")[1]
        line.send(theatre_seats.REPORT.pack(theatre_seats.MAGIC, number, late, not follower or follower.settled.is_set()))
        return True

    GLib.timeout_add_seconds(theatre_seats.EVERY, report)
    pipeline.use_clock(clock)
    pipeline.set_start_time(Gst.CLOCK_TIME_NONE)
    pipeline.set_base_time(0)
    pipeline.set_latency(options.latency * Gst.MSECOND)
    return pipeline


def main():
    options = parse(sys.argv[1:])
    Gst.init(None)
    pipeline = make(options)
    print("ready", flush=True)
    sys.exit(theatre.run(pipeline))


if __name__ == "__main__":
    main()
