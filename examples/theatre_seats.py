# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reports of the seats to the server: how many are there, and how many of them are late."""
import queue
import socket
import struct
import threading

REPORT = struct.Struct(">4sIQ?")  # MAGIC, a number that the seat drew, commands that were late since its start, whether its clock is settled
MAGIC = b"seat"
EVERY = 2  # s from one report to the next
GONE = 10  # s without a report
MOST = 10000  # seats: a stranger's packets use no more memory


class Seats:
    """What the server knows of them. Times are in s, of any clock."""

    def __init__(self):
        self.seats = {}  # number: (time of the report, late commands, whether any were since the one before or the clock is lost)

    def add(self, now, packet):
        """A packet from the network. Other packets than reports are ignored."""
        if len(packet) != REPORT.size:
            return
        magic, number, late, settled = REPORT.unpack(packet)
        if magic != MAGIC:
            return
        before = self.seats.pop(number)[1] if number in self.seats else late
        if len(self.seats) >= MOST:
            del self.seats[next(iter(self.seats))]  # the one that has been silent for longest
        self.seats[number] = (now, late, late > before or not settled)

    def count(self, now):
        """(seats, late ones of them)"""
        self.seats = {number: seat for number, seat in self.seats.items() if now - seat[0] < GONE}
        return len(self.seats), sum(late for _, _, late in self.seats.values())


class Line:
    """Sends to the server, as soon as a network leads there. A thread of its own waits for names and networks."""

    def __init__(self, server, port):
        self.server, self.port = server, port
        self.packets = queue.SimpleQueue()
        threading.Thread(target=self._send, daemon=True).start()

    def send(self, packet):
        self.packets.put(packet)

    def _send(self):
        line = None
        while True:
            packet = self.packets.get()
            while not self.packets.empty():
                packet = self.packets.get()
            try:
                if not line:
                    kind, _, _, _, address = socket.getaddrinfo(self.server, self.port, type=socket.SOCK_DGRAM)[0]
                    line = socket.socket(kind, socket.SOCK_DGRAM)
                    line.connect(address)
                line.send(packet)
            except (OSError, UnicodeError):  # no such name, no network, another one than before, or no server yet
                if line:
                    line.close()
                line = None


def lines_at(addresses, port):
    """Sockets on which the seats are heard, which never block."""
    lines = []
    for own in addresses:
        kind, _, _, _, address = socket.getaddrinfo(own, port, type=socket.SOCK_DGRAM)[0]
        line = socket.socket(kind, socket.SOCK_DGRAM)
        line.setblocking(False)
        try:
            line.bind(address)
            lines.append(line)
        except OSError as error:
            print(f"seats cannot report at {own}:{port}: {error.strerror}", flush=True)
            line.close()
    return lines
