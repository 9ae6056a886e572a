#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Shows a film and sends its tactile maps to the seats of a theatre."""
import argparse
import contextlib
import sys
import time

import theatre
import theatre_seats
from theatre import GLib, Gst, GstNet


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("film", help="file or URI")
    parser.add_argument(
        "--to", action="append", metavar="ADDRESS:PORT", help="destination of maps, also a multicast group; may be repeated (default: 239.255.42.42:5104)"
    )
    parser.add_argument(
        "--from", dest="own", metavar="ADDRESS", help="this computer's address, for maps and the clock (default: for each --to, its address on the interface "
        "that leads there)"
    )
    parser.add_argument("--latency", type=int, default=theatre.LATENCY, metavar="MS", help="delay of the picture after its map was sent; the same for all seats")
    parser.add_argument("--rate", type=float, default=5, metavar="HZ", help="rate at which levels may change")
    parser.add_argument("--copies", type=int, default=3, help="number of packets for each map, 50 ms apart, in case that some are lost")
    parser.add_argument("--clock-port", type=int, default=theatre.CLOCK_PORT)
    parser.add_argument("--ptp", type=int, metavar="DOMAIN", help="follow the grandmaster of this PTP domain, as the seats do, instead of providing a clock")
    parser.add_argument("--analysis", default="", help="properties of saliencytactile, such as 'rows=2 columns=4'")
    parser.add_argument("--video-sink", default="autovideosink", help="a launch line")
    parser.add_argument("--audio-sink", default="autoaudiosink", help="a launch line")
    return parser.parse_args(arguments)


def by_own_address(clients, own):
    """Groups clients by this computer's address on the way to them."""
    groups = {}
    for client in clients:
        groups.setdefault(own or theatre.own_address(client.rpartition(":")[0]), []).append(client)
    return groups


def sender(number, own, clients, latency):
    """Sends a map when its frame would be shown without the latency, and copies 50 ms after one another."""
    delay = max(latency - 50 * number, 0) * Gst.MSECOND
    return (
        f"copies. ! queue ! multiudpsink bind-address={own} clients={','.join(clients)} sync=true async=false auto-multicast=true ttl-mc=8 "
        f"render-delay={delay}"
    )


def hear_seats(own, port):
    """Prints how many seats there are, and how many of them are late, whenever that changes. Returns what is known of them."""
    seats, told = theatre_seats.Seats(), (0, 0)

    def read(line, _condition):
        # As soon as reports come: a socket keeps only some hundreds of them.
        with contextlib.suppress(OSError):
            for _ in range(theatre_seats.MOST):
                seats.add(time.monotonic(), line.recv(64))
        return True

    def tell():
        nonlocal told
        now = seats.count(time.monotonic())
        if now != told:
            print("seats: %d, late: %d" % now, flush=True)
        told = now
        return True

    for line in theatre_seats.lines_at(own, port):
        GLib.io_add_watch(line, GLib.PRIORITY_DEFAULT, GLib.IO_IN, read)
    GLib.timeout_add_seconds(1, tell)
    return seats


def main():
    options = parse(sys.argv[1:])
    Gst.init(None)
    clients = by_own_address(options.to or [f"239.255.42.42:{theatre.PORT}"], options.own)
    room = f"queue max-size-bytes=0 max-size-buffers=0 max-size-time={(options.latency + 300) * Gst.MSECOND}"
    screen = Gst.parse_bin_from_description(
        f"saliencytactile name=analysis max-rate={options.rate} {options.analysis} ! tactileextractor name=split "
        f"split.src ! {room} ! videoconvert ! {options.video_sink} "
        f"split.tactile ! {room} ! rtpgstpay name=pay ssrc={theatre.SSRC} config-interval=1 ! rtp.send_rtp_sink_0 "
        "rtpbin name=rtp ntp-time-source=clock-time rtcp-sync-send-time=false "
        "rtp.send_rtp_src_0 ! tee name=copies "
        + " ".join(sender(number, own, clients[own], options.latency) for number in range(options.copies) for own in clients),
        False,
    )
    screen.add_pad(Gst.GhostPad.new("sink", screen.get_by_name("analysis").get_static_pad("sink")))
    extension = Gst.ElementFactory.make("rtphdrextntp64")
    extension.set_id(theatre.EXTENSION)
    screen.get_by_name("pay").emit("add-extension", extension)

    play = Gst.ElementFactory.make("playbin3")
    play.set_property("uri", options.film if Gst.uri_is_valid(options.film) else Gst.filename_to_uri(options.film))
    play.set_property("video-sink", screen)
    play.set_property("audio-sink", Gst.parse_bin_from_description(options.audio_sink, True))

    if options.ptp is None:
        clock = Gst.SystemClock.obtain()
        providers = [GstNet.NetTimeProvider.new(clock, own, options.clock_port) for own in clients]
    else:
        clock = theatre.ptp_clock(options.ptp)
        providers = []
    hear_seats(clients, options.clock_port + 1)
    play.use_clock(clock)
    play.set_latency(options.latency * Gst.MSECOND)

    sent = {"packets": 0, "bytes": 0}

    def count(_pad, info):
        # A buffer list: a map after caps or other events.
        packets = [info.get_buffer()] if info.type & Gst.PadProbeType.BUFFER else info.get_buffer_list()
        if isinstance(packets, Gst.BufferList):
            packets = [packets.get(i) for i in range(packets.length())]
        sent["packets"] += len(packets)
        sent["bytes"] += sum(packet.get_size() for packet in packets)
        return Gst.PadProbeReturn.OK

    screen.get_by_name("copies").get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER | Gst.PadProbeType.BUFFER_LIST, count)

    def playing():
        if play.get_state(0)[1] != Gst.State.PLAYING:
            return True
        print(f"playing, base time {play.get_base_time()} ns, latency {options.latency} ms", flush=True)
        return False

    GLib.timeout_add(20, playing)

    def ended():
        seconds = max((clock.get_time() - play.get_base_time()) / Gst.SECOND - options.latency / 1000, 0.001)
        # IPv4 and UDP add 28 bytes to each packet.
        rate = options.copies * 8 * (sent["bytes"] + 28 * sent["packets"]) / seconds
        print(f"sent {options.copies} x {sent['packets']} packets, {rate / 1000:.1f} kbit/s with IP and UDP", flush=True)

    status = theatre.run(play, ended)
    del providers
    sys.exit(status)


if __name__ == "__main__":
    main()
