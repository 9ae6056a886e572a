# SPDX-License-Identifier: LGPL-2.1-or-later
"""A film whose frames show their numbers and whose seconds begin with a tone, and an Xvfb screen of which is known when which frame came to it.

As a program, it watches a screen's memory: follow_screen.py FILE prints "EARLIEST LATEST NUMBER" of each frame, times in seconds of CLOCK_MONOTONIC between which it came."""

import mmap
import os
import struct
import subprocess
import sys
import threading
import time

RATE = 24  # frames a second
BITS = 14  # of a frame's number, in Gray code, the lowest first, between a white and a black bar
BARS = BITS + 2
WIDTH, HEIGHT = 640, 360
LOOK_EVERY = 0.0005  # s
KNOWN_TO = 0.003  # s: frames whose time is known less exactly do not count


SOUND = "if(lt(mod(t\\,1)\\,0.05)\\,0.5*sin(2*PI*1000*t)\\,0)"  # begins with each second


def make_film(path, seconds, sound=None):
    """`sound`: a file instead of the tones."""
    rows = bytearray()
    for number in range(seconds * RATE):
        gray = number ^ (number >> 1)
        rows += bytes([235] + [235 if gray >> bit & 1 else 16 for bit in range(BITS)] + [16])
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "gray", "-s", f"{BARS}x1", "-r", str(RATE), "-i", "-",
                    *(["-i", str(sound)] if sound else ["-f", "lavfi", "-i", f"aevalsrc={SOUND}:s=48000:d={seconds}"]), "-c:a", "flac",
                    "-vf", f"scale={WIDTH}:{HEIGHT}:flags=neighbor,format=yuv420p", "-c:v", "libx264", "-preset", "ultrafast", "-qp", "8", "-g", str(RATE),
                    str(path)], input=bytes(rows), check=True)
    os.chmod(path, 0o644)


def number_of(bars):
    """A frame's number; none if the bars show no frame."""
    if not bars[0] or bars[-1]:
        return None
    number, bit = 0, 0
    for bar in reversed(bars[1:-1]):
        bit ^= bar
        number = number << 1 | bit
    return number


def watch(file):
    """Looks at the screen all the time. Only what has not changed at the next look counts, so that half a frame is none."""
    with open(file, "rb") as opened:
        memory = mmap.mmap(opened.fileno(), 0, prot=mmap.PROT_READ)
    # An X window dump, in the order of a network.
    header, = struct.unpack_from(">I", memory, 0)
    bits_per_pixel, bytes_per_line = struct.unpack_from(">II", memory, 44)
    colors, = struct.unpack_from(">I", memory, 76)
    pixel = bits_per_pixel // 8
    line = header + colors * 12 + HEIGHT // 4 * bytes_per_line
    places = [line + (bar * WIDTH // BARS + WIDTH // BARS // 2) * pixel + 1 for bar in range(BARS)]
    shown, new, before = None, None, time.monotonic()
    while True:
        number = number_of([memory[place] >= 128 for place in places])
        now = time.monotonic()
        if new and number == new[2]:
            if number is not None:
                print(*new, flush=True)
            shown, new = number, None
        elif number != shown:
            new = (before, now, number)
        else:
            new = None
        before = now
        time.sleep(LOOK_EVERY)


class Screen:
    """Xvfb's."""

    def __init__(self, folder):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-noreset", "-ac", "-fbdir", str(folder), "-screen", "0", f"{WIDTH}x{HEIGHT}x24"],
                                       pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read, encoding="ascii") as line:
            self.name = ":" + line.readline().strip()
        self.frames = []  # (earliest, latest, position)
        self.watcher = subprocess.Popen([sys.executable, __file__, str(folder / "Xvfb_screen0")], stdout=subprocess.PIPE, text=True)
        threading.Thread(target=self._listen, daemon=True).start()

    def stop(self):
        for process in (self.watcher, self.server):
            process.kill()
            process.wait()

    def _listen(self):
        for line in self.watcher.stdout:
            earliest, latest, number = line.split()
            self.frames.append((float(earliest), float(latest), int(number) / RATE))

    def now(self):
        """The film's position by the newest frame; none if it is older than two frames and the film therefore stands."""
        if not self.frames:
            return None
        _, latest, position = self.frames[-1]
        age = time.monotonic() - latest
        return position + age if age < 2.5 / RATE else None

    def known(self, begin, end):
        """(time, position) of the frames that came meanwhile and whose time is known well."""
        return [((earliest + latest) / 2, position) for earliest, latest, position in list(self.frames)
                if begin < latest < end and latest - earliest < KNOWN_TO]


if __name__ == "__main__":
    watch(sys.argv[1])
