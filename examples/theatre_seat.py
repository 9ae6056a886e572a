#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A seat of a theatre: plays what theatre_server.py sends on the motors of one chair."""
import argparse
import sys

import theatre
import theatre_clock
from theatre import Gst


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server", help="its address, for the clock")
    parser.add_argument("--group", metavar="ADDRESS", default="239.255.42.42", help="multicast group of the maps")
    parser.add_argument("--unicast", action="store_true", help="maps are sent to this seat alone, at its address on the interface that leads to the server")
    parser.add_argument("--port", type=int, default=theatre.PORT)
    parser.add_argument("--clock-port", type=int, default=theatre.CLOCK_PORT)
    parser.add_argument("--ptp", type=int, metavar="DOMAIN", help="follow the grandmaster of this PTP domain instead of the server's clock, as the server does")
    parser.add_argument("--latency", type=int, default=theatre.LATENCY, metavar="MS", help="the server's")
    parser.add_argument("--jitter", type=int, default=150, metavar="MS", help="how long a packet is waited for; with the motors' lead, 190 ms, less than the latency")
    parser.add_argument("--chair", default="", help="properties of tactorsink, as in 'intensity=0.5'")
    return parser.parse_args(arguments)


def make(options):
    """The pipeline, with the network's clock; running time is that clock's time."""
    follower = None if options.ptp is not None else theatre_clock.Follower(options.server, options.clock_port)
    while follower and not follower.settled.wait(10):
        print(f"waiting for the clock of {options.server}", flush=True)

    address = theatre.own_address(options.server) if options.unicast else options.group
    pipeline = Gst.parse_launch(
        f'udpsrc name=maps address={address} port={options.port} caps="{theatre.CAPS}" ! rtp.recv_rtp_sink_0 '
        f"rtpbin name=rtp ntp-sync=true ntp-time-source=clock-time buffer-mode=none latency={options.jitter} "
        # The server has chosen when what is felt may change.
        f"rtpgstdepay name=depay ! tactorsink name=chair rate=0 {options.chair}"
    )

    # udpsrc would bind a group's port on all addresses, and so hear what is sent to this computer alone as well.
    pipeline.get_by_name("maps").set_property("socket", theatre.bound_socket(address, options.port))

    def is_ours(_pad, info):
        return Gst.PadProbeReturn.OK if info.get_buffer().extract_dup(8, 4) == theatre.SSRC.to_bytes(4, "big") else Gst.PadProbeReturn.DROP

    # By itself a session believes in a source after two packets in sequence (RFC 3550, A.1). With copies and jitter these come by chance,
    # after some seconds or not at all; but whom to hear is known.
    pipeline.get_by_name("maps").get_static_pad("src").add_probe(Gst.PadProbeType.BUFFER, is_ours)
    pipeline.get_by_name("rtp").emit("get-session", 0).set_property("probation", 0)

    def on_pad(_rtp, pad):
        if pad.get_name().startswith("recv_rtp_src"):
            depay = pipeline.get_by_name("depay").get_static_pad("sink")
            if depay.is_linked():
                depay.get_peer().unlink(depay)
            pad.link(depay)

    pipeline.get_by_name("rtp").connect("pad-added", on_pad)
    if follower:
        # Nothing is better than something at the wrong time.
        chair = pipeline.get_by_name("chair")
        mute = chair.get_property("mute")

        def silence(settled):
            chair.set_property("mute", mute or not settled)

        def on_change(settled):
            print(f"the clock of {options.server} is {'known again' if settled else 'no longer known: silent'}", flush=True)
            silence(settled)

        follower.on_change = on_change
        silence(follower.settled.is_set())
    pipeline.use_clock(follower.clock if follower else theatre.ptp_clock(options.ptp))
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
