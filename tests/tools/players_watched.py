# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a player showed and did: playerwatch's files, the screen, the processes."""
import bisect
import collections
import csv
import os
import pathlib
import subprocess
import time

from players_known import LIMIT

SECOND = 1_000_000_000  # ns
FILM, NEXT_FILM = 16 / 9, 4 / 3  # films are told apart by their shape: some players scale before the sink
RESET = SECOND // 2  # ns by which running times fall back where they begin anew


Line = collections.namedtuple("Line", "sink kind running shown film width height")
Command = collections.namedtuple("Command", "issued due effect tactor volts")


def rows(path, kind):
    """Whole lines: the player may be writing."""
    with open(path, encoding="utf-8", newline="") as file:
        text = file.read()
    whole = text[:text.rfind("\n") + 1].splitlines()
    return [kind(*row) for row in csv.reader(line for line in whole if not line.startswith("issued"))]


def watched(folder):
    for path in sorted(folder.glob("watch-*.csv")):
        for line in rows(path, Line):
            yield Line(line.sink, line.kind, *map(int, line[2:]))


def shape(line):
    """Which film it is of, or none: players begin with a frame of a pixel."""
    return next((film for film in (FILM, NEXT_FILM) if line.width > 8 and abs(line.width / line.height - film) < 0.05), None)


def frames(folder, film=FILM):
    return [line for line in watched(folder) if line.kind == "frame" and shape(line) == film]


def epochs(items, time_of):
    """Running times begin anew after a seek and with another pipeline."""
    parts, last = [], None
    for item in items:
        if last is None or time_of(item) < last - RESET:
            parts.append([])
        parts[-1].append(item)
        last = time_of(item)
    return parts


def matched(folder):
    """Commands that start or change a vibration, and the frame that each is for: (command, frame)."""
    shown = epochs([line for line in watched(folder) if line.kind == "frame" and shape(line)], lambda frame: frame.shown)
    traces = sorted(folder.glob("commands-*.csv"), key=lambda path: path.stat().st_mtime)
    pairs, at, last = [], 0, 0
    for trace in traces:
        for part in epochs([Command(*map(float, command)) for command in rows(trace, Command)], lambda command: command.issued):
            planned = [command for command in part if command.due < command.effect and command.volts > 0]
            if not planned:
                continue
            # Both are in the order of time: the same epoch of the frames or a later one that reaches as far.
            at += planned[0].issued < last - RESET
            last = planned[-1].issued
            while at < len(shown) and shown[at][-1].shown < planned[-1].issued - RESET:
                at += 1
            if at >= len(shown):
                break
            by_time = sorted(shown[at], key=lambda frame: frame.running)
            times = [frame.running for frame in by_time]
            for command in planned:
                near = bisect.bisect_left(times, command.effect - 1_000_000)
                if near < len(times) and times[near] <= command.effect + 1_000_000:
                    pairs.append((command, by_time[near]))
    return pairs


def not_at_zero(folder):
    """Tactors that are left on."""
    left = 0
    for trace in folder.glob("commands-*.csv"):
        last = {command.tactor: float(command.volts) for command in rows(trace, Command)}
        left += sum(volts != 0 for volts in last.values())
    return left


def screen(env, target, encoder="videoconvert ! video/x-raw,format=RGB"):
    plain = {key: value for key, value in env.items() if key not in ("GST_TRACERS", "GST_PLUGIN_PATH_1_0")} | {"GST_REGISTRY_1_0": f"{env['HOME']}/plain.registry"}
    subprocess.run(f"gst-launch-1.0 -q ximagesrc num-buffers=1 show-pointer=false ! {encoder} ! filesink location={target}".split(), env=plain,
                   capture_output=True, timeout=LIMIT, check=False)
    return pathlib.Path(target).read_bytes()


def moves(env, folder):
    """Whether the screen changes as the film does, whose ball rests at times."""
    one = screen(env, folder / "one.raw")
    for _ in range(6):
        time.sleep(0.2)
        other = screen(env, folder / "other.raw")
        if len(one) == len(other) and sum(abs(a - b) > 20 for a, b in zip(one, other)) > 300:
            return True
    return False


def family(process):
    parents = {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parents[int(stat.parent.name)] = int(stat.read_text(encoding="utf-8").rpartition(")")[2].split()[1])
        except (OSError, IndexError):
            continue
    members = {process}
    while True:
        more = {child for child, parent in parents.items() if parent in members} - members
        if not more:
            return members
        members |= more


def usage(process):
    """CPU in s and memory in MB (PSS) of a process and its children."""
    cpu = memory = 0
    for member in family(process):
        try:
            fields = pathlib.Path(f"/proc/{member}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            rollup = pathlib.Path(f"/proc/{member}/smaps_rollup").read_text(encoding="utf-8")
        except OSError:
            continue
        cpu += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        memory += next((int(line.split()[1]) for line in rollup.splitlines() if line.startswith("Pss:")), 0) / 1024
    return cpu, memory
