#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""theatre_clock.Offset on simulated networks with a known offset: its error after it reports that it has settled.

Usage: clock.py EXAMPLES
"""
import heapq
import random
import socket
import sys
import threading
import time

from gi.repository import GLib

sys.path.insert(0, sys.argv[1])
from theatre_clock import Follower, Offset  # noqa: E402
from theatre_server import hear_seats  # noqa: E402
from theatre_seats import GONE, MAGIC, MOST, REPORT, Line, Seats  # noqa: E402

SECOND = 10**9
BEGIN = 123456 * SECOND
AHEAD = 987654321 * 10**6  # ns: the server's clock, at BEGIN


def follow(delay, seconds=75, drift=lambda t: 0.0, loss=0.01, lost=(0, 0), ahead=lambda t: AHEAD, seed=1):
    """(s until settled, largest error in ms while settled, s unsettled later) of a simulated seat."""
    chance = random.Random(seed)
    offset = Offset()
    now, fitted, truth_then = BEGIN, 0, 0.0
    settled_at, unsettled, worst_error = None, 0.0, 0.0
    answers = []
    drifted = 0.0

    def truth(t):
        return ahead((t - BEGIN) / SECOND) + drifted

    while now < BEGIN + seconds * SECOND:
        step = int(offset.ask_again * SECOND)
        t = (now - BEGIN) / SECOND
        if chance.random() >= 2 * loss and not lost[0] <= t < lost[1]:
            there, back = delay(chance), delay(chance)
            answers.append((now + there + back, now, now + there + truth(now + there)))
        now += step
        drifted += drift(t) * step
        for answer in sorted(answer for answer in answers if answer[0] <= now):
            offset.add(round(answer[1]), round(answer[2]), round(answer[0]))
            answers.remove(answer)
        if now - fitted >= SECOND // 10:
            fitted = now
            offset.fit(now)
        if offset.settled:
            settled_at = t if settled_at is None else settled_at
            reference, server = offset.server_time()
            error = server + (now - reference) * (1 + offset.drift) - now - truth(now)
            worst_error = max(worst_error, abs(error) / 1e6)
        elif settled_at is not None:
            unsettled += step / SECOND
    return settled_at, worst_error, unsettled


def uniform(least, jitter):
    return lambda chance: (least + chance.uniform(0, jitter)) * 1e6


def exponential(least, mean):
    return lambda chance: (least + chance.expovariate(1 / mean)) * 1e6


def share(seats, answers, seconds=30, waiting=250):
    """(s until all seats have settled, questions without an answer in all) of a server that answers one after the other, so many a second. So many may wait."""
    chance = random.Random(1)
    offsets = [Offset() for _ in range(seats)]
    events = [(BEGIN + chance.uniform(0, SECOND), n, None) for n in range(seats)]  # time, seat, (asked, server's time): an answer
    heapq.heapify(events)
    fitted, settled = [0] * seats, {}
    free, lost = 0, 0  # when the server has answered all
    while events and len(settled) < seats:
        now, n, answer = heapq.heappop(events)
        offset = offsets[n]
        if answer:
            offset.add(round(answer[0]), round(answer[1] + AHEAD), round(now))
            continue
        if now > BEGIN + seconds * SECOND:
            break
        heapq.heappush(events, (now + offset.ask_again * SECOND, n, None))
        arrived = now + chance.uniform(0.1, 0.3) * 1e6
        if free - arrived < waiting * SECOND / answers:
            free = max(free, arrived) + SECOND / answers
            heapq.heappush(events, (free + chance.uniform(0.1, 0.3) * 1e6, n, (now, free)))
        else:
            lost += 1
        if now - fitted[n] >= SECOND // 10:
            fitted[n] = now
            offset.fit(now)
            if offset.settled:
                settled.setdefault(n, (now - BEGIN) / SECOND)
                reference, server = offset.server_time()
                if abs(server - reference - AHEAD) > 20e6:
                    return None, lost  # another time than the server's
    return max(settled.values()) if len(settled) == seats else None, lost


failed = 0


def expect(name, result, settled, error, unsettled=0.0):
    global failed
    good = result[0] is not None and result[0] <= settled and result[1] <= error and result[2] <= unsettled
    failed += not good
    print(f"{name}: settled after {result[0]} s, {result[1]:.3f} ms off at most, then unsettled for {result[2]:.1f} s{'' if good else f'; expected {settled} s, {error} ms, {unsettled} s: FAILED'}")


def worst(**network):
    runs = [follow(seed=seed, **network) for seed in (1, 2, 3)]
    return max(run[0] if run[0] is not None else 1e9 for run in runs), max(run[1] for run in runs), max(run[2] for run in runs)


expect("0.1 to 1.1 ms", worst(delay=uniform(0.1, 1)), 1.0, 0.3)
expect("0.1 to 20.1 ms", worst(delay=uniform(0.1, 20)), 8.0, 1.0)
expect("0.1 to 20.1 ms, 80 ppm", worst(delay=uniform(0.1, 20), drift=lambda t: 80e-6), 8.0, 1.0)
expect("0.1 to 20.1 ms, a rate that changes", worst(delay=uniform(0.1, 20), drift=lambda t: 20e-6 if t < 45 else -20e-6), 8.0, 1.5)
expect("1 ms and exponential, 5 ms", worst(delay=exponential(1, 5)), 8.0, 1.0)
expect("half of all lost", worst(delay=uniform(0.1, 20), loss=0.25), 16.0, 1.0)
# At first, the seats together ask twelve times as often as the server can answer.
together, lost = share(seats=60, answers=500)
print(f"60 seats, 500 answers a second: all are settled after {together} s, {lost} questions without an answer")
failed += together is None
# It keeps its estimate in between.
expect("no network for 20 s", worst(delay=uniform(0.1, 20), lost=(30, 50)), 8.0, 1.0)
expect("no network for 70 s", worst(delay=uniform(0.1, 20), lost=(10, 80), seconds=95), 8.0, 1.0, 75.0)
expect("no server", (0, 0, 0) if follow(delay=uniform(0.1, 1), loss=0.5)[0] is None else (None, 0, 0), 0, 0)
# Between two exchanges the error can be the whole step, which is not an error of the fit.
stepped = Offset()
for n in range(400):
    now = BEGIN + n * SECOND // 4
    ahead = AHEAD if n < 300 else 5 * SECOND
    stepped.add(now, now + 10**5 + ahead, now + 2 * 10**5)
    stepped.fit(now + 2 * 10**5)
    if n == 300 and stepped.settled and abs(stepped.server_time()[1] - stepped.server_time()[0] - ahead) > 1e6:
        print("FAILED: settled across a step of the server's clock")
        failed += 1
if not stepped.settled or abs(stepped.server_time()[1] - stepped.server_time()[0] - 5 * SECOND) > 1e5:
    print("FAILED: does not follow a step of the server's clock")
    failed += 1
# A peer that sends invalid times, before and after the offset is known.
hostile = Offset()
for n in range(400):
    now = BEGIN + n * SECOND // 4
    server = now + 10**5 + AHEAD if 100 <= n < 300 else (0, 2**63, 2**64 - 1)[n % 3]
    hostile.add(now, server, now + 2 * 10**5)
    hostile.fit(now + 2 * 10**5)
    reference, told = hostile.server_time()
    if not 0 <= reference < 2**63 or not 0 <= told < 2**63 or hostile.settled and abs(told - reference - AHEAD) > 1e5:
        print(f"FAILED: follows what is no time: {told} at {reference}")
        failed += 1
# Reports of 300 seats: 7 play late, 2 have no clock, one leaves, and strangers send.
seats = Seats()
for second in range(0, 20, 2):
    for n in range(300):
        if n != 9 or second < 4:
            seats.add(second, REPORT.pack(MAGIC, n, 5 + (second if n < 7 else 0), n not in (7, 8)))
    for packet in (b"", b"seat", bytes(REPORT.size), REPORT.pack(b"taes", 1, 2**64 - 1, False), bytes(1000)):
        seats.add(second, packet)
    wanted = (299 if second - 2 >= GONE else 300, 2 if second == 0 else 9)
    if seats.count(second) != wanted:
        print(f"FAILED: {seats.count(second)} seats and late ones at {second} s, expected {wanted}")
        failed += 1
for n in range(2 * MOST):
    seats.add(20, REPORT.pack(MAGIC, 1000 + n, 0, True))
seats.add(20, REPORT.pack(MAGIC, 7, 0, False))
if seats.count(20) != (MOST, 1) or seats.count(20 + GONE) != (0, 0):
    print("FAILED: seats that a stranger makes up, or that have gone, are kept, or keep out others")
    failed += 1
# A seat far away says why it waits.
far = Offset()
said = [far.hindrance]
for n in range(400):
    now = BEGIN + n * SECOND // 4
    far.add(now, now + 25 * 10**6 + AHEAD, now + 50 * 10**6)
    far.fit(now + 50 * 10**6)
if far.settled or [*said, far.hindrance] != ["no answer", "expected answers within 40 ms, the quickest took 50.0 ms"]:
    print(f"FAILED: {said}, {far.hindrance}, settled: {far.settled}")
    failed += 1
# So does one whose answers scatter, or are few.
scattered, chance = Offset(), random.Random(1)
scattered.add(BEGIN, BEGIN + AHEAD, BEGIN + 10**6)
scattered.fit(BEGIN + 10**6)
if scattered.hindrance != "expected 20 answers that agree, got 1":
    print(f"FAILED: {scattered.hindrance}")
    failed += 1
for n in range(40):
    now = BEGIN + n * SECOND // 4
    there, back = (chance.randrange(1, 200) * 10**6 for _ in range(2))
    scattered.add(now, now + there + AHEAD, now + there + back)
    scattered.fit(now + there + back)
if scattered.settled or not scattered.hindrance.startswith("expected 0.2 ms of uncertainty, got "):
    print(f"FAILED: {scattered.hindrance}, settled: {scattered.settled}")
    failed += 1
# A name that cannot be one is refused in words, not with Python's of its codecs.
for name in ("." * 3, "a" * 64 + ".example"):
    try:
        Follower(name, 5105)
        why = "no refusal"
    except SystemExit as refusal:
        why = str(refusal)
    if "parts of a name have 1 to 63 letters" not in why:
        print(f"FAILED: {name}: {why}")
        failed += 1
# A seat does not wait for the name of its server.
resolve, answered = socket.getaddrinfo, threading.Event()
socket.getaddrinfo = lambda *_arguments, **_named: answered.wait() and []
waiting = Line("server", 5107)
waiting.send(b"")
waiting.send(b"")
socket.getaddrinfo = resolve
# More reports than a socket keeps, which the server reads before a second is over.
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
heard = hear_seats(["127.0.0.1"], port)
line = Line("127.0.0.1", port)
reporter = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
for n in range(1000):
    reporter.sendto(REPORT.pack(MAGIC, n, 0, True), ("127.0.0.1", port))
    if n % 100 == 99:
        while GLib.MainContext.default().iteration(False):
            pass
line.send(REPORT.pack(MAGIC, 1000, 0, True))
while len(heard.seats) == 1000:
    GLib.MainContext.default().iteration(True)
if heard.count(time.monotonic())[0] != 1001:
    print(f"FAILED: {len(heard.seats)} seats were heard, expected 1001")
    failed += 1
sys.exit(failed > 0)
