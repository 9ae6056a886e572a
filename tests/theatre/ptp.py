#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A seat's PTP clock against a grandmaster: linuxptp's ptp4l with software time stamps in one network namespace, the clock that
`theatre_seat.py --ptp 0` follows in another. The grandmaster's time is this computer's, so that the error is known.

Usage: ptp.py EXAMPLES      (skipped, with status 77, where network namespaces may not be made)
"""
import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
import time

OFF = 1e6  # ns
CONFIGURATION = "[global]\ntime_stamping software\nmasterOnly 1\nclockClass 128\nlogSyncInterval -3\nlogAnnounceInterval 0\nlogMinDelayReqInterval -3\n[eth0]\n"


def follow():
    """In the seat's namespace."""
    import theatre

    theatre.Gst.init(None)
    clock = theatre.ptp_clock(0, ["eth0"])
    errors = []
    for _ in range(2000):
        before, told, after = time.clock_gettime_ns(time.CLOCK_REALTIME), clock.get_time(), time.clock_gettime_ns(time.CLOCK_REALTIME)
        if after - before < 50000:  # else it was interrupted
            errors.append(abs(told - (before + after) // 2))
        if len(errors) == 100:
            break
        time.sleep(0.02)
    errors.sort()
    print(f"PTP: off by {errors[len(errors) // 2] / 1e6:.3f} ms (median), {errors[-1] / 1e6:.3f} ms (most of {len(errors)} readings)")
    if len(errors) < 100 or errors[-1] > OFF:
        raise SystemExit(f"FAILED: expected at most {OFF / 1e6} ms and 100 readings")


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
        seat = ["ip", "netns", "exec", names[1], sys.executable, __file__, "--seat"]
        return subprocess.run(seat, env={**os.environ, "PYTHONPATH": examples}, timeout=150, check=False).returncode


if __name__ == "__main__":
    sys.exit(follow() if sys.argv[1] == "--seat" else main(os.path.abspath(sys.argv[1])))
