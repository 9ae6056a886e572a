#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A theatre on one computer: a server and three seats, each behind a network that drops 1 % of the packets and delays each by up to
20 ms. Seats are in their own network namespaces if these can be created, otherwise on loopback.

One seat plays the whole film, one loses its network for a while, and one joins late. The last one's network duplicates and reorders
packets, and a stranger sends to its port. At the end all play a second, short film of a new server. The traces of commands are compared
with those of a play without network, in running time: soon after a seat's first map it must play everything. Times that depend on the
machine's speed are printed only.

Usage: seats.py EXAMPLES [REPORT]      (with the plugins on GST_PLUGIN_PATH; REPORT receives the figures)
"""
import contextlib
import csv
import os
import random
import selectors
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

LOSS = 0.01
JITTER = 0.020  # s
LATENCY = 1500  # ms: minus the motors' 190, how long processes may be delayed on a busy computer
LATE = 600  # ms: how long a seat waits for a packet
FILM = 26  # s
SECOND = 6  # s of it are the second film
SOON = 1.2e9  # ns after its first map a seat plays: caps come once a second
SAME = 2e6  # ns
CLOCK_OFF = 1e6  # ns, or what its own exchanges leave open: on a busy computer each takes longer
# Each map gives a command, and no limit depends on when a seat joined.
CHAIR = "driver=simulator ramp-in=0 max-active=0 max-duty=0 max-on-time=0"


# ---- the network -----------------------------------------------------------------------------------------------------
def map_time(packet):
    """Display time of the map in ns: the 64-bit NTP time stamp in the packet's only extension (RFC 8285, RFC 6051). None for the first
    packets of a showing, which have no time yet."""
    if packet[0] != 0x90 or packet[12:14] != b"\xbe\xde" or packet[16] & 0xF != 7:
        return None
    return int.from_bytes(packet[17:25], "big") * 10**9 >> 32


def packet_number(packet):
    return int.from_bytes(packet[2:4], "big")


def relay(maps_in, maps_out, clock_in, server, clock_out, seed, nuisance):
    """Forwards maps to 127.0.0.1:maps_out and clock queries to server:clock_out. Drops everything from SIGUSR1 to SIGUSR2.

    Tells the time of the newest map that was handed on before, and of the first one after. With `nuisance`, no two packets leave in
    sequence: in between comes one that was there before, and a stranger's.
    """
    import asyncio

    chance = random.Random(seed)
    state = {"up": True, "back": False, "newest": 0}

    def down(*_):
        state.update(up=False)
        print("down", state["newest"], flush=True)

    signal.signal(signal.SIGUSR1, down)
    signal.signal(signal.SIGUSR2, lambda *_: state.update(up=True, back=True))

    async def work():
        loop = asyncio.get_running_loop()

        def later(send):
            if state["up"] and chance.random() >= LOSS:
                loop.call_later(chance.uniform(0, JITTER), send)

        class Link(asyncio.DatagramProtocol):
            def connection_made(self, transport):
                self.transport = transport

        class Maps(Link):
            def __init__(self):
                self.before = self.last = None  # of different numbers

            def datagram_received(self, data, _address):
                if not state["up"]:
                    return
                shown = map_time(data)
                if shown and state["back"]:
                    state["back"] = False
                    print("back", shown, flush=True)
                state["newest"] = max(state["newest"], shown or 0)
                later(lambda: self.hand_on(data))

            def hand_on(self, data):
                if nuisance and self.before and packet_number(data) == (packet_number(self.last) + 1) % 2**16:
                    self.transport.sendto(self.before, ("127.0.0.1", maps_out))
                    self.transport.sendto(data[:8] + b"else" + data[12:], ("127.0.0.1", maps_out))
                self.transport.sendto(data, ("127.0.0.1", maps_out))
                if not self.last or packet_number(data) != packet_number(self.last):
                    self.before, self.last = self.last, data

        class Answer(asyncio.DatagramProtocol):
            def __init__(self, back):
                self.back = back

            def datagram_received(self, data, _address):
                later(lambda: self.back(data))

        class Clock(Link):
            def __init__(self):
                self.there = {}

            def datagram_received(self, data, address):
                asyncio.ensure_future(self.ask(data, address))

            async def ask(self, data, address):
                if address not in self.there:
                    self.there[address], _ = await loop.create_datagram_endpoint(
                        lambda: Answer(lambda reply: self.transport.sendto(reply, address)), remote_addr=(server, clock_out)
                    )
                later(lambda: self.there[address].sendto(data))

        await loop.create_datagram_endpoint(Maps, local_addr=("0.0.0.0", maps_in))
        await loop.create_datagram_endpoint(Clock, local_addr=("127.0.0.1", clock_in))
        await asyncio.Event().wait()

    # asyncio's loop has a resolution of a millisecond.
    asyncio.SelectorEventLoop(selectors.SelectSelector()).run_until_complete(work())


def seat(arguments):
    """theatre_seat.py that also reports the time of the first map of each showing and, at the end, its clock's offset from the computer's,
    which is the server's."""
    import theatre
    import theatre_clock
    import theatre_seat
    from theatre import GLib, Gst

    offsets = []
    left_open = [0]  # when the clock was set: what its exchanges say that the offset is at most, less what it is at least
    play = theatre.run
    fit = theatre_clock.Offset.fit

    def fit_and_note(offset, now):
        fit(offset, now)
        if offset.settled:
            left_open.append(min(most for _, most, _ in offset.exchanges) - max(least for _, _, least in offset.exchanges))

    theatre_clock.Offset.fit = fit_and_note

    def run(pipeline):
        truth = Gst.SystemClock.obtain()

        def read():
            # Readings that took longer were interrupted.
            for _ in range(100):
                before, told, after = truth.get_time(), pipeline.get_clock().get_time(), truth.get_time()
                if after - before < 50000:
                    offsets.append(told - (before + after) // 2)
                    break
            return True

        GLib.timeout_add(20, read)
        return play(pipeline, lambda: print("left_open", max(left_open), "\noffsets", *offsets, flush=True))

    def first(_pad, info):
        print("first", map_time(info.get_buffer().extract_dup(0, 25)), flush=True)
        return Gst.PadProbeReturn.REMOVE

    hear = theatre_seat.Maps.__init__

    def hear_and_tell(maps, *arguments):
        hear(maps, *arguments)
        maps.bin.get_by_name("depay").get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, first)

    theatre_seat.Maps.__init__ = hear_and_tell
    theatre.run = run
    sys.argv[1:] = arguments
    theatre_seat.main()


class Namespaces:
    """A network namespace for each seat, linked with this one. Without permission, names for loopback."""

    def __init__(self, stack, count):
        self.names = []
        self.prefix = f"vt{os.getpid()}"
        self.net = f"10.{64 + os.getpid() // 256 % 128}.{os.getpid() % 256}"  # of this test alone
        for number in range(count if shutil.which("ip") else 0):
            name = f"{self.prefix}-{number}"
            if subprocess.run(["ip", "netns", "add", name], stderr=subprocess.DEVNULL, check=False).returncode:
                break
            stack.callback(subprocess.run, ["ip", "netns", "del", name], check=False)
            self.names.append(name)
            for command in (
                f"ip link add {self.prefix}h{number} type veth peer name eth0 netns {name}",
                f"ip addr add {self.server(number)}/30 dev {self.prefix}h{number}",
                f"ip link set {self.prefix}h{number} up",
                f"ip -n {name} addr add {self.address(number)}/30 dev eth0",
                f"ip -n {name} link set eth0 up",
                f"ip -n {name} link set lo up",
            ):
                subprocess.run(command.split(), check=True)

    def __bool__(self):
        return bool(self.names)

    def command(self, number):
        return ["ip", "netns", "exec", self.names[number]] if self else []

    def server(self, number):
        return f"{self.net}.{4 * number + 1}" if self else "127.0.0.1"

    def address(self, number):
        return f"{self.net}.{4 * number + 2}" if self else "127.0.0.1"


def free_ports(count):
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


# ---- the results -----------------------------------------------------------------------------------------------------
def trace(path, base=0, played=True):
    """Planned commands as (effect in the film, tactor, volts), and all as (issued in the film, tactor, volts, late)."""
    planned, told = [], []
    with open(path, newline="", encoding="ascii") as file:
        for line in csv.DictReader(file):
            issued, due, effect = (int(line[f"{name}_ns"]) for name in ("issued", "due", "effect"))
            command = (effect - base, int(line["tactor"]), float(line["volts"]))
            told.append((issued - base, *command[1:], issued - due))
            # Commands that were not planned (silence without maps) take effect when issued.
            if not played or effect != issued:
                planned.append(command)
    return planned, told


def expect(condition, text):
    if not condition:
        raise SystemExit(f"FAILED: {text}")


def felt_from(reference, time):
    """The first time at or after this one at which something is felt."""
    levels = {}
    for effect, tactor, volts in reference:
        if effect > time and any(levels.values()):
            return time
        levels[tactor] = volts
        if effect > time and volts:
            return effect
    raise SystemExit(f"FAILED: nothing is felt after {time / 1e9:.3f} s")


def compare(name, commands, reference, after, end):
    """Compares all commands that take effect from soon after a time in the film to another time."""
    begun = min((command[0] for command in commands if command[0] >= after - SAME), default=end)
    soonest = felt_from(reference, after)
    expect(begun <= soonest + SOON, f"{name}: begins at {begun / 1e9:.3f} s, though it could at {soonest / 1e9:.3f} s")
    # The first are the levels at that time, whenever they began.
    start = begun + SAME
    left = [command for command in commands if start <= command[0] < end]
    count = 0
    worst = 0
    for effect, tactor, volts in (command for command in reference if start <= command[0] < end):
        match = [c for c in left if c[1:] == (tactor, volts) and abs(c[0] - effect) <= SAME]
        expect(match, f"{name}: no command like tactor {tactor}, {volts} V at {effect / 1e9:.3f} s among {[c for c in commands if abs(c[0] - effect) < 1e8]}")
        worst = max(worst, abs(match[0][0] - effect))
        left.remove(match[0])
        count += 1
    expect(not left, f"{name}: {len(left)} commands more than without a network, first {left[:1]}")
    expect(count > 0, f"{name}: nothing to compare")
    return f"{name}: {count} commands from {begun / 1e9:.1f} s on as without a network, at most {worst / 1e6:.3f} ms off"


def main(examples, report):
    python = "/usr/bin/python3"
    lines = []
    with contextlib.ExitStack() as stack:
        work = stack.enter_context(tempfile.TemporaryDirectory())
        film, second = (os.path.join(work, f"film{seconds}.mkv") for seconds in (FILM, SECOND))
        analysis = "temporal=false"
        for path, seconds in ((film, FILM), (second, SECOND)):
            source = f"tactiletestsrc pattern=dynamic-motion num-buffers={seconds * 30} ! video/x-raw,format=I420,width=160,height=120,framerate=30/1"
            subprocess.run(f"gst-launch-1.0 -q {source} ! jpegenc ! matroskamux ! filesink location={path}".split(), check=True)
        subprocess.run(
            f"gst-launch-1.0 -q filesrc location={film} ! matroskademux ! jpegdec ! saliencytactile max-rate=5 {analysis} ! "
            f"tactorsink rate=0 sync=false {CHAIR} trace-location={work}/reference.csv".split(),
            check=True,
        )
        reference, _ = trace(f"{work}/reference.csv", played=False)

        networks = Namespaces(stack, 3)
        lines.append(f"three seats, {'in network namespaces' if networks else 'on loopback'}, {LOSS:.0%} loss, {JITTER * 1000:.0f} ms jitter of maps and clock")
        ports = free_ports(10)
        clock_port = ports[9]
        maps_in, maps_out, clocks = ports[0:3], ports[3:6], ports[6:9]
        processes = []

        def start(name, command):
            log = stack.enter_context(open(os.path.join(work, f"{name}.log"), "w+", encoding="utf-8"))
            process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env={**os.environ, "PYTHONPATH": examples})
            stack.callback(lambda: process.poll() is not None or process.kill())
            process.log = log.name
            processes.append((name, process))
            return process

        def said(process, what):
            with open(process.log, encoding="utf-8") as log:
                return next((line for line in log if line.startswith(what)), None)

        def wait_for(process, what):
            while not said(process, what):
                expect(process.poll() is None, open(process.log, encoding="utf-8").read())
                time.sleep(0.02)
            return said(process, what)

        relays = [
            start(
                f"relay{n}",
                networks.command(n)
                + [python, __file__, "--relay", *map(str, (maps_in[n], maps_out[n], clocks[n], networks.server(n), clock_port, n + 1, n == 2))],
            )
            for n in range(3)
        ]

        def start_seat(number):
            chair = f"{CHAIR} trace-location={work}/seat{number}.csv"
            return start(
                f"seat{number}",
                networks.command(number)
                + [python, __file__, "--seat", "127.0.0.1", "--unicast", "--port", str(maps_out[number])]
                + ["--clock-port", str(clocks[number]), "--latency", str(LATENCY), "--jitter", str(LATE), "--chair", chair],
            )

        # A seat waits for its clock, the server does not wait, so the first two seats miss only their own start.
        seats = [start_seat(0), start_seat(1)]
        to = [argument for n in range(3) for argument in ("--to", f"{networks.address(n)}:{maps_in[n]}")]

        def show(name, path):
            server = start(
                name,
                [python, os.path.join(examples, "theatre_server.py"), path, *to, "--latency", str(LATENCY), "--clock-port", str(clock_port)]
                + ["--analysis", analysis, "--video-sink", "fakesink sync=true", "--audio-sink", "fakesink"],
            )
            return server, int(wait_for(server, "playing").split()[3])

        def has_ended(server):
            expect(server.wait() == 0, open(server.log, encoding="utf-8").read())
            return said(server, "sent").strip()

        server, base = show("server", film)
        place = lambda: time.monotonic_ns() - base  # noqa: E731

        def wait_until(seconds):
            while place() < seconds * 1e9 and server.poll() is None:
                time.sleep(0.02)

        for one in seats:
            wait_for(one, "ready")
        wait_until(3)
        seats.append(start_seat(2))
        wait_until(15)
        os.kill(relays[1].pid, signal.SIGUSR1)
        wait_until(18)
        os.kill(relays[1].pid, signal.SIGUSR2)
        lines.append(f"server: {has_ended(server)}")
        server, base_of_second = show("second", second)
        has_ended(server)
        time.sleep(1.5)  # no assertion hangs on it: seats silence their motors when no map comes, or else when they are told to end
        for one in seats:
            one.terminate()
        for one in seats:
            expect(one.wait() == 0, open(one.log, encoding="utf-8").read())

        for name, process in processes:
            with open(process.log, encoding="utf-8") as log:
                for line in log:
                    if not line.startswith(("playing", "sent", "down", "back", "ready", "first", "left_open", "offsets")):
                        print(f"{name}: {line.rstrip()}", file=sys.stderr)

        def times_told(process, word):
            with open(process.log, encoding="utf-8") as log:
                times = [int(line.split()[1]) for line in log if line.startswith(word)]
            expect(times, f"{os.path.basename(process.log)} does not say {word}")
            return times

        def time_told(process, word):
            return times_told(process, word)[0] - base

        end = FILM * 1e9
        cut, back = time_told(relays[1], "down"), time_told(relays[1], "back")
        traces = [trace(f"{work}/seat{n}.csv", base) for n in range(3)]
        first = [time_told(one, "first") for one in seats]
        lines.append(compare("seat that plays all", traces[0][0], reference, first[0], end))
        # Other copies of the map may arrive later.
        lines.append(compare("seat before its network is lost", traces[1][0], reference, first[1], cut - 0.2e9))
        lines.append(compare("seat after its network is back", traces[1][0], reference, back, end))
        lines.append(compare("seat that joins late", traces[2][0], reference, first[2], end))
        for n in range(3):
            played, _ = trace(f"{work}/seat{n}.csv", base_of_second)
            first_of_second = next((time for time in times_told(seats[n], "first") if time > base_of_second), None)
            expect(first_of_second, f"seat {n} does not hear the second film")
            lines.append(compare(f"seat {n}, second film", played, reference, first_of_second - base_of_second, SECOND * 1e9))

        # Maps from before the cut are played. The last is held for a second and the motors' lead, then there is silence.
        levels = {}
        for issued, tactor, volts, _ in traces[1][1]:
            if issued > back - 0.5e9:
                break
            levels[tactor] = volts
        expect(not any(levels.values()), f"the seat without a network is not silent: {levels}")
        silent = max(issued - late for issued, _, _, late in traces[1][1] if issued < back - 0.5e9)
        expect(silent < cut + 1.3e9, f"the seat without a network was silent {(silent - cut) / 1e9:.2f} s after its last map")
        lines.append(f"seat without a network: silent {(silent - cut) / 1e9:.2f} s after it was lost")
        for number, (_, told) in enumerate(traces):
            last = {tactor: volts for _, tactor, volts, _ in told}
            expect(not any(last.values()), f"seat {number} leaves motors on: {last}")
            offsets = [abs(int(text)) / 1e6 for text in said(seats[number], "offsets").split()[1:]]
            late = sorted(command[3] / 1e6 for command in told)
            expect(len(offsets) > 50, f"seat {number}: the clock was only read {len(offsets)} times")
            left_open = int(said(seats[number], "left_open").split()[1])
            expect(max(offsets) * 1e6 < max(CLOCK_OFF, left_open), f"seat {number}: its clock was off by {max(offsets):.2f} ms, its exchanges leave {left_open / 1e6:.2f} ms open")
            lines.append(
                f"seat {number}: clock off by {statistics.median(offsets):.2f} ms (median), {max(offsets):.2f} ms (most of {len(offsets)}), {left_open / 1e6:.2f} ms left open; "
                f"commands {statistics.median(late):.2f} ms late (median), {late[int(len(late) * 0.95)]:.2f} ms (19 of 20)"
            )
    print("\n".join(lines))
    if report:
        with open(report, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--relay"]:
        relay(int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), sys.argv[5], int(sys.argv[6]), int(sys.argv[7]), sys.argv[8] == "True")
    elif sys.argv[1:2] == ["--seat"]:
        seat(sys.argv[2:])
    else:
        # Leaves no process and no network behind.
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        # In real time: on a busy computer a seat may be delayed for longer than its latency.
        for showing in range(3):
            try:
                main(os.path.abspath(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else None)
                break
            except SystemExit as failure:
                print(failure, file=sys.stderr)
                if showing == 2:
                    raise
