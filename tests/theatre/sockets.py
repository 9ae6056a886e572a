#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which UDP ports server and seats of a theatre bind when they are told no address: those that docs/guide/security.md lists, and none on all
addresses; and that a seat hears two films of its group. In a network namespace of its own, with one interface; where none can be made, the
test is skipped.

Usage: sockets.py EXAMPLES      (with the plugins on GST_PLUGIN_PATH)
"""
import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time

OWN = "10.9.8.7"  # the only address but loopback's
GROUP = "239.255.42.42"
MAPS, CLOCK, REPORTS, ALONE = 5104, 5106, 5107, 5108
SKIPPED = 77  # meson's
PYTHON = "/usr/bin/python3"


def expect(condition, text):
    if not condition:
        raise SystemExit(f"FAILED: {text}")


def address_of(text):
    """Parses the kernel's address:port, in hexadecimal and host byte order."""
    address, port = text.split(":")
    parts = bytes.fromhex(address)
    if len(parts) != 4:
        return f"[{address}]", int(port, 16)
    return ".".join(map(str, parts[::-1] if sys.byteorder == "little" else parts)), int(port, 16)


def bound(process):
    """(address, port, whether it is connected to one peer) of every UDP socket of a process."""
    inodes = set()
    for handle in os.listdir(f"/proc/{process.pid}/fd"):
        with contextlib.suppress(OSError):
            inodes.add(os.readlink(f"/proc/{process.pid}/fd/{handle}"))
    found = []
    for table in ("udp", "udp6"):
        with open(f"/proc/{process.pid}/net/{table}", encoding="ascii") as lines:
            for line in list(lines)[1:]:
                fields = line.split()
                if f"socket:[{fields[9]}]" in inodes:
                    found.append((*address_of(fields[1]), fields[3] == "01"))
    return sorted(found)


def main(examples):
    for command in (
        "ip link set lo up",
        "ip link add theatre type veth peer name street",
        f"ip addr add {OWN}/24 dev theatre",
        "ip link set theatre up",
        "ip link set street up",
        "ip route add 224.0.0.0/4 dev theatre",
    ):
        subprocess.run(command.split(), check=True)
    with contextlib.ExitStack() as stack:
        work = stack.enter_context(tempfile.TemporaryDirectory())
        film = os.path.join(work, "film.mkv")
        subprocess.run(
            f"gst-launch-1.0 -q tactiletestsrc pattern=dynamic-motion num-buffers=200 ! video/x-raw,width=160,height=120,framerate=20/1 ! jpegenc ! matroskamux ! filesink location={film}".split(),
            check=True,
        )

        def start(program, *arguments, until):
            log = stack.enter_context(open(os.path.join(work, f"{program}{len(arguments)}"), "w+", encoding="utf-8"))
            process = subprocess.Popen([PYTHON, os.path.join(examples, program), *arguments], stdout=log, stderr=subprocess.STDOUT)
            stack.callback(lambda: process.poll() is not None or process.kill())
            while True:
                log.seek(0)
                said = log.read()
                if until in said:
                    return process
                expect(process.poll() is None, said)
                time.sleep(0.05)

        def show():
            return start("theatre_server.py", film, "--video-sink", "fakesink sync=true", "--audio-sink", "fakesink", "--analysis", "temporal=false", until="playing")

        server = show()
        commands = os.path.join(work, "commands.csv")
        seat = start("theatre_seat.py", OWN, "--chair", f"driver=simulator trace-location={commands}", until="ready")
        alone = start("theatre_seat.py", OWN, "--unicast", "--port", str(ALONE), "--chair", "driver=simulator", until="ready")
        at = {name: bound(process) for name, process in (("server", server), ("seat", seat), ("seat alone", alone))}
        server.wait()
        second = time.monotonic_ns()  # which is the server's clock
        show().wait()
        for process in (seat, alone):
            process.send_signal(signal.SIGTERM)
            process.wait()
        with open(commands, encoding="ascii") as lines:
            told = [int(line.split(",")[0]) for line in list(lines)[1:]]

    expect(any(issued < second for issued in told), "what was sent to the group was not heard")
    expect(any(issued > second + 2e9 for issued in told), "the second film was not heard")  # by then the first one's last map is over
    for name, sockets in at.items():
        print(name, *(f"{address}:{port}{' (one peer)' if connected else ''}" for address, port, connected in sockets))
    # The kernel chooses the source ports of maps and of clock queries.
    own = [port for address, port, connected in at["server"] if address == OWN and not connected]
    expect(len(own) == len(at["server"]) and {CLOCK, REPORTS} <= set(own), "the server binds more than its own address")
    for name, wanted in (("seat", (GROUP, MAPS, False)), ("seat alone", (OWN, ALONE, False))):
        expect(wanted in at[name], f"{name}: {wanted} is not bound")
        expect(all(connected and address == OWN for address, _, connected in at[name] if (address, _, connected) != wanted), f"{name} binds more")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        main(os.path.abspath(sys.argv[1]))
    elif subprocess.run(["unshare", "-rn", "true"], stderr=subprocess.DEVNULL, check=False).returncode:
        print("no network namespace can be made here")
        sys.exit(SKIPPED)
    else:
        os.execvp("unshare", ["unshare", "-rn", PYTHON, __file__, sys.argv[1], "inside"])
