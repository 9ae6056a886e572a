# SPDX-License-Identifier: LGPL-2.1-or-later
"""A seat's clock: a GstSystemClock that follows the server's GstNetTimeProvider over a network with jitter.

GstNetClientClock fits a line through the middles of the round trips. Each is wrong by half the difference of its two delays, and
after a long round trip the next request is delayed. With 20 ms jitter, errors of milliseconds remain. But a delay is never
negative: the server reads its clock after the request was sent and before the reply arrived. So each exchange bounds the offset
on both sides, and the quickest packet of each direction counts, not the quickest pair: the middle between the bounds of n
exchanges has an error of jitter / n, not of jitter / sqrt(n). Cf. D. Mills, "Internet Time Synchronization: the Network Time Protocol",
IEEE Trans. Commun. 39(10), 1991 (clock filter); V. Paxson, "On Calibrating Measurements of Packet Transit Times", SIGMETRICS 1998
(minima of each direction, skew). As for any clock over a network, the difference between the least delays of the two
directions remains unknown: an error of at most half of the shortest round trip.
"""
import collections
import socket
import struct
import threading
import time

from theatre import GObject, Gst

PACKET = struct.Struct(">QQ")  # GstNetTimePacket: when it was asked, on the seat's clock, and the server's time, in ns
WINDOW = 60 * 10**9  # ns: how long an exchange counts
MOST_EXCHANGES = 2000
MOST_DRIFT = 120e-6  # of one computer's clock against another's; crystals have 50e-6
SETTLED = 200e3  # ns: see Offset.uncertainty
UNSETTLED = 600e3  # ns: it takes more to lose what was settled
FINE = 50e3  # ns: from here on it is asked less often
EARLIEST, LATEST = 10**9, 2**62  # ns, of the server's clock: what is reckoned from it fits a GstClockTime
DENSITY = 10  # packets of each direction from which it is told how dense they lie at the bound
ASK_OFTEN = 0.01  # s from one question to the next
ASK_SELDOM = 0.25  # also of a server whose answers take long
ANSWERS = 10  # from which it is told whether questions wait at the server
QUICK = 20e6  # ns: the quickest of these takes no longer, beyond the quickest of all; jitter does not touch the quickest, a queue does
LONGEST = 2 * QUICK  # ns: half of the shortest round trip is the error that cannot be seen


def _hull(points):
    """The lower convex hull of (x, y) with rising x."""
    hull = []
    for x, y in points:
        while len(hull) > 1 and (hull[-1][1] - hull[-2][1]) * (x - hull[-2][0]) >= (y - hull[-2][1]) * (hull[-1][0] - hull[-2][0]):
            hull.pop()
        hull.append((x, y))
    return hull


class Offset:
    """The offset of the server's clock from this computer's, and its uncertainty. All times in ns."""

    def __init__(self):
        self.exchanges = collections.deque(maxlen=MOST_EXCHANGES)
        self.settled = False
        self.begin, self.origin = 0, 0  # all times are relative to these, so that doubles are precise
        self.reference, self.ahead, self.drift = 0, 0.0, 0.0
        self.uncertainty = float("inf")  # what the offset is expected to be off by, the packets being as dense at the bounds as seen
        self.pace = ASK_OFTEN
        self.answers = 0  # since the pace was set

    def add(self, asked, server, answered):
        """An exchange: sent and received on this computer's clock, the server's time in between. Invalid times are ignored."""
        if not EARLIEST <= server <= LATEST:
            return
        if not self.exchanges:
            self.begin, self.origin = asked, server - asked
        # At `asked`, the offset is at most the first and at least the second.
        self.exchanges.append((asked - self.begin, server - asked - self.origin, server - answered - self.origin))
        self.answers += 1
        if self.answers == ANSWERS:
            self.answers = 0
            trips = self._trips()
            waits = min(trips[-ANSWERS:]) > min(*trips, QUICK) + QUICK
            self.pace = min(2 * self.pace, ASK_SELDOM) if waits else max(self.pace / 2, ASK_OFTEN)

    def fit(self, now):
        self._fit(now)
        self.settled = self.uncertainty <= (UNSETTLED if self.settled else SETTLED) and min(self._trips()) <= LONGEST

    @property
    def hindrance(self):
        """Why it has not settled, in words."""
        trips = self._trips()
        if not trips:
            return "no answer"
        if min(trips) > LONGEST:
            return f"expected answers within {LONGEST / 1e6:.0f} ms, the quickest took {min(trips) / 1e6:.1f} ms"
        if self.uncertainty == float("inf"):
            return f"expected {2 * DENSITY} answers that agree, got {len(trips)}"
        return f"expected {SETTLED / 1e6} ms of uncertainty, got {self.uncertainty / 1e6:.1f} ms from {len(trips)} answers"

    def _trips(self):
        return [most - least for _, most, least in list(self.exchanges)]  # which its thread extends meanwhile

    def _fit(self, now):
        """Fits the line with the greatest distance from all bounds."""
        while self.exchanges and self.exchanges[0][0] + self.begin < now - WINDOW:
            self.exchanges.popleft()
        while len(self.exchanges) >= 2 * DENSITY:
            late = now - self.begin
            most = [(x - late, most) for x, most, _ in self.exchanges]
            least = [(x - late, -least) for x, _, least in self.exchanges]
            upper, lower = _hull(sorted(most)), _hull(sorted(least))

            def bounds(drift):
                return min(y - drift * x for x, y in upper), -min(y + drift * x for x, y in lower)

            # The distance is concave in the drift.
            low, high = -MOST_DRIFT, MOST_DRIFT
            while high - low > 1e-9:
                third = (high - low) / 3
                (a, b), (c, d) = bounds(low + third), bounds(high - third)
                low, high = (low + third, high) if a - b < c - d else (low, high - third)
            drift = (low + high) / 2
            above, below = bounds(drift)
            if above >= below:
                self.reference, self.ahead, self.drift = now, (above + below) / 2, drift
                above = sorted(y - drift * x for x, y in most)[DENSITY - 1] - above
                below = sorted(y + drift * x for x, y in least)[DENSITY - 1] + below
                # Extrapolation beyond the exchanges that were fitted.
                beyond = 1 + 2 * -most[-1][0] / max(most[-1][0] - most[0][0], 1)
                self.uncertainty = (above + below) / DENSITY * beyond
                return
            # The bounds contradict each other: a clock was set, or its rate has changed.
            for _ in range((len(self.exchanges) + 1) // 2):
                self.exchanges.popleft()
        self.uncertainty = float("inf")

    @property
    def ask_again(self):
        """Seconds until the next request."""
        return ASK_SELDOM if self.uncertainty <= FINE else self.pace

    def server_time(self):
        """(this computer's time, the server's at that time)"""
        return self.reference, self.reference + self.origin + round(self.ahead)


class Follower:
    """Synchronizes `clock` with the server's in a thread of its own, which calls `on_change(settled)`."""

    def __init__(self, server, port, on_change=None):
        self.clock = GObject.new(Gst.SystemClock, name="theatre")
        self.on_change = on_change or (lambda settled: None)
        self.settled = threading.Event()
        self.offset = Offset()
        try:
            self.family, _, _, _, self.address = socket.getaddrinfo(server, port, type=socket.SOCK_DGRAM)[0]
        except (OSError, UnicodeError) as error:
            why = error.strerror if isinstance(error, OSError) else "parts of a name have 1 to 63 letters"
            raise SystemExit(f"expected the server's address or name, got '{server}': {why}") from error
        threading.Thread(target=self._follow, daemon=True).start()

    def _exchange(self, line, seconds):
        """Sends one request and receives replies until the next is due."""
        try:
            line.send(PACKET.pack(self.clock.get_internal_time(), Gst.CLOCK_TIME_NONE))
        except OSError:
            pass  # no network, or no server yet
        end = self.clock.get_internal_time() + int(seconds * 1e9)
        while (left := end - self.clock.get_internal_time()) > 0:
            line.settimeout(left / 1e9)
            try:
                answer = line.recv(64)
            except TimeoutError:
                return
            except OSError:
                continue
            answered = self.clock.get_internal_time()
            if len(answer) == PACKET.size:
                asked, server = PACKET.unpack(answer)
                if asked <= answered < asked + Gst.SECOND:
                    self.offset.add(asked, server, answered)

    def _follow(self):
        with socket.socket(self.family, socket.SOCK_DGRAM) as line:
            while line.connect_ex(self.address):
                time.sleep(1)  # no network leads there yet
            fitted = 0
            while True:
                self._exchange(line, self.offset.ask_again)
                now = self.clock.get_internal_time()
                if now - fitted < 100 * Gst.MSECOND:
                    continue
                fitted = now
                self.offset.fit(now)
                if self.offset.settled:
                    self.clock.set_calibration(*self.offset.server_time(), 10**9 + round(self.offset.drift * 1e9), 10**9)
                if self.offset.settled != self.settled.is_set():
                    (self.settled.set if self.offset.settled else self.settled.clear)()
                    self.on_change(self.offset.settled)
