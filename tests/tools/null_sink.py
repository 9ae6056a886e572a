# SPDX-License-Identifier: LGPL-2.1-or-later
"""A PulseAudio of its own, whose sound nobody hears."""

import os
import subprocess
import sys
import time

RATE = 44100  # samples a second: PulseAudio's default
LATEST = 20  # s


def appears(path):
    end = time.monotonic() + LATEST
    while not os.path.exists(path):
        if time.monotonic() > end:
            sys.exit(f"the sound server does not start: expected its socket {path} within {LATEST} s")
        time.sleep(0.05)


class NullSink:
    """`socket` is the path of its socket, at which anybody is let in. `more`: launch lines of modules."""

    def __init__(self, folder, *more):
        self.socket = f"{folder}/pulse.socket"
        env = os.environ | {name: str(folder) for name in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME", "HOME")}
        try:
            self.process = subprocess.Popen(["pulseaudio", "-n", "--daemonize=no", "--exit-idle-time=-1", "--use-pid-file=no", "--log-level=error",
                                             "--load=module-null-sink sink_name=null", *(f"--load={line}" for line in more),
                                             f"--load=module-native-protocol-unix socket={self.socket} auth-anonymous=1"], env=env)
        except FileNotFoundError:
            sys.exit("there is no pulseaudio: run tools/setup.sh test")
        try:
            appears(self.socket)
        except BaseException:
            self.stop()
            raise

    def stop(self):
        self.process.terminate()
        self.process.wait()
