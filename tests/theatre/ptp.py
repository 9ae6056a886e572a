#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A seat's PTP clock against a grandmaster: linuxptp's ptp4l with software time stamps in one network namespace, the clock that
`theatre_seat.py --ptp 0` follows in another. The grandmaster's time is this computer's, so that the errors of each measurement and of the clock are known.
How far off they are is for the computer and its load to say. That it follows this grandmaster, and is as good as what it measures, is asserted.

Usage: ptp.py EXAMPLES      (skipped, with status 77, where network namespaces may not be made)
"""
import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
import time

READINGS = 100
MEASUREMENTS = 48
WORSE = 3  # a line through measurements may be worse than they are where it goes on beyond them
RESOLUTION = 20e3  # ns: what reading two clocks leaves open
CONFIGURATION = "[global]\ntime_stamping software\nmasterOnly 1\nclockClass 128\nlogSyncInterval -3\nlogAnnounceInterval 0\nlogMinDelayReqInterval -3\n[eth0]\n"


def ahead():
    """CLOCK_REALTIME (the grandmaster's) minus CLOCK_MONOTONIC (GStreamer's): the tightest of many readings."""
    readings = []
    for _ in range(1000):
        before, real, after = time.monotonic_ns(), time.clock_gettime_ns(time.CLOCK_REALTIME), time.monotonic_ns()
        readings.append((after - before, real - (before + after) // 2))
    return min(readings)[1]


def follow(identity):
    """Runs in the seat's namespace."""
    import theatre

    theatre.Gst.init(None)
    measured = []

    def note(_domain, stats, *_):
        if stats.get_name() == theatre.GstNet.PTP_STATISTICS_TIME_UPDATED:
            measured.append(stats.get_value("ptp-time") - stats.get_value("local-time"))
        return True

    truth = ahead()
    theatre.GstNet.ptp_statistics_callback_add(note)
    clock = theatre.ptp_clock(0, ["eth0"])
    errors = []
    # Longer than the 32 measurements of the fit.
    while len(errors) < READINGS or len(measured) < MEASUREMENTS:
        before, told, after = time.monotonic_ns(), clock.get_time(), time.monotonic_ns()
        # It was read at any time in between.
        errors.append(max(0, told - after - truth, before + truth - told))
        time.sleep(0.02)
    step = abs(ahead() - truth)  # if the computer's clock was set meanwhile
    errors.sort()
    worst = max(abs(one - truth) for one in measured)
    print(
        f"PTP: off by {errors[len(errors) // 2] / 1e6:.3f} ms (median), {errors[-1] / 1e6:.3f} ms (most of {len(errors)} readings); "
        f"its {len(measured)} measurements by {worst / 1e6:.3f} ms at most"
    )
    for what, value in (("domain", 0), ("grandmaster-clock-id", identity), ("master-clock-id", identity)):
        if clock.get_property(what) != value:
            raise SystemExit(f"FAILED: the clock's {what} is {clock.get_property(what):x}, expected {value:x}")
    if errors[-1] > WORSE * worst + RESOLUTION + step:
        raise SystemExit(f"FAILED: expected at most {WORSE} times what its measurements are off by")


def identity_of(namespace):
    """The clock identity from the port's EUI-48 (IEEE 1588, 7.5.2.2)."""
    address = subprocess.run(["ip", "netns", "exec", namespace, "cat", "/sys/class/net/eth0/address"], check=True, capture_output=True, text=True).stdout
    octets = bytes.fromhex(address.strip().replace(":", ""))
    return int.from_bytes(octets[:3] + b"\xff\xfe" + octets[3:], "big")


def main(examples):
    for program in ("ip", "ptp4l"):
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin"):
            raise SystemExit(f"there is no {program}: run tools/setup.sh")
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    names = [f"vp{os.getpid()}-{role}" for role in ("master", "seat")]
    with contextlib.ExitStack() as stack:
        for name in names:
            if subprocess.run(["ip", "netns", "add", name], stderr=subprocess.DEVNULL, check=False).returncode:
                print("network namespaces cannot be made here")
                return 77
            stack.callback(subprocess.run, ["ip", "netns", "del", name], check=False)
        subprocess.run(f"ip link add eth0 netns {names[0]} type veth peer name eth0 netns {names[1]}".split(), check=True)
        for number, name in enumerate(names):
            for command in ("link set lo up", "link set eth0 up", f"addr add 10.99.0.{number + 1}/24 dev eth0", "route add 224.0.0.0/4 dev eth0"):
                subprocess.run(["ip", "-n", name, *command.split()], check=True)
        file = stack.enter_context(tempfile.NamedTemporaryFile("w"))
        file.write(CONFIGURATION)
        file.flush()
        master = subprocess.Popen(["ip", "netns", "exec", names[0], "ptp4l", "-f", file.name, "-m"], stdout=subprocess.DEVNULL)
        stack.callback(master.wait)
        stack.callback(master.terminate)
        seat = ["ip", "netns", "exec", names[1], sys.executable, __file__, "--seat", str(identity_of(names[0]))]
        return subprocess.run(seat, env={**os.environ, "PYTHONPATH": examples}, timeout=150, check=False).returncode


if __name__ == "__main__":
    sys.exit(follow(int(sys.argv[2])) if sys.argv[1] == "--seat" else main(os.path.abspath(sys.argv[1])))
