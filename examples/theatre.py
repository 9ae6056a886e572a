# SPDX-License-Identifier: LGPL-2.1-or-later
"""What server and seats of a theatre share.

Maps are sent as RTP (rtpgstpay). Each packet has the time at which its map is shown, on the network's clock (RFC 6051). A seat
can join at any time: it needs only the clock, the stream and the latency. To use that time before the first RTCP report, a
receiver has to know the stream's CNAME; hence a fixed SSRC.
"""
import socket

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstNet", "1.0")
gi.require_version("GstRtp", "1.0")
from gi.repository import Gio, GLib, GObject, Gst, GstNet, GstRtp  # noqa: E402, F401

SSRC = 0x74726561
EXTENSION = 1  # its number in the packets
CAPS = (
    "application/x-rtp,media=application,clock-rate=90000,encoding-name=X-GST,payload=96,"
    f"ssrc=(uint){SSRC},ssrc-{SSRC}-cname=theatre,extmap-{EXTENSION}=urn:ietf:params:rtp-hdrext:ntp-64"
)
OUR_EXTENSION = bytes((0xBE, 0xDE, 0, 3, EXTENSION << 4 | 7))  # RFC 8285: three words of extensions, the first one with 8 bytes
HEADER = 25  # bytes of a packet up to the end of that extension
SAME_START = 90  # ticks of a time stamp: 1 ms
LONG_SILENCE = 10 << 32  # s
PORT = 5104  # of the maps
CLOCK_PORT = 5106
LATENCY = 500  # ms from when a map leaves the server until its frame is shown


def own_address(destination):
    """This computer's address on the interface that leads to `destination`, a name or an address. Sends nothing."""
    kind, _, _, _, address = socket.getaddrinfo(destination, 9, type=socket.SOCK_DGRAM)[0]
    with socket.socket(kind, socket.SOCK_DGRAM) as line:
        try:
            line.connect(address)
        except OSError as error:
            raise SystemExit(f"no network leads to {destination}: {error.strerror}") from error
        return line.getsockname()[0]


def times(packet):
    """Two times of a map's packet: the RTP time stamp at which its showing began, and when the map is shown, in 2^-32 s of the network's
    clock. None for another source's packets, and for a showing's first packets, which have no time; their caps are sent again."""
    if len(packet) < HEADER or packet[0] != 0x90 or packet[8:12] != SSRC.to_bytes(4, "big") or packet[12:17] != OUR_EXTENSION:
        return None
    time = int.from_bytes(packet[17:HEADER], "big")
    return (time * 90000 >> 32) - int.from_bytes(packet[4:8], "big"), time


def bound_socket(address, port):
    """A UDP socket that receives only packets to this address or group."""
    place = Gio.InetSocketAddress.new_from_string(address, port)
    if not place:
        raise SystemExit(f"expected an address, got {address}")
    line = Gio.Socket.new(place.get_family(), Gio.SocketType.DATAGRAM, Gio.SocketProtocol.UDP)
    try:
        line.bind(place, place.get_address().get_is_multicast())
    except GLib.Error as error:
        raise SystemExit(f"{address}:{port} cannot be heard: {error.message}") from error
    return line


def ptp_clock(domain, interfaces=None):
    """The clock of this PTP domain's grandmaster (IEEE 1588); waits until it is synchronized."""
    if not GstNet.ptp_init(GstNet.PTP_CLOCK_ID_NONE, interfaces):
        raise SystemExit("PTP cannot be used: GStreamer's gst-ptp-helper needs the right to open ports 319 and 320")
    clock = GstNet.PtpClock.new("theatre", domain)
    while not clock.wait_for_sync(10 * Gst.SECOND):
        print(f"waiting for the clock of PTP domain {domain}", flush=True)
    return clock


def run(pipeline, ended=None):
    """Plays until the end of the stream, an error, SIGINT or SIGTERM. Returns the exit status."""
    loop = GLib.MainLoop()
    status = [0]

    def on_message(_bus, message):
        if message.type == Gst.MessageType.ERROR:
            error, debug = message.parse_error()
            print(f"{message.src.get_name()}: {error.message} ({debug})", flush=True)
            status[0] = 1
        elif message.type == Gst.MessageType.WARNING:
            print(f"{message.src.get_name()}: {message.parse_warning()[0].message}", flush=True)
        if message.type in (Gst.MessageType.ERROR, Gst.MessageType.EOS):
            loop.quit()

    bus = pipeline.get_bus()
    bus.add_signal_watch()
    bus.connect("message", on_message)
    for signal in (2, 15):
        GLib.unix_signal_add(GLib.PRIORITY_HIGH, signal, loop.quit)
    pipeline.set_state(Gst.State.PLAYING)
    loop.run()
    if ended:
        ended()
    pipeline.set_state(Gst.State.NULL)
    return status[0]
