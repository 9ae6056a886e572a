#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Films that are stopped while they open, after 0 to 50 ms: with visuotactiledecoder, with visuotactilesink and without any of ours. Prints a
table: runs whose opens all ended, and the open at which a run froze (30 s). Each run is a process of its own; a frozen one is killed.

Usage: stopped_opens.py [--runs N] [--opens N] [--players LIST] [--with LIST] FILM...     (3; 300; playbin,playbin3; none,decoder,sink)
Expects GST_PLUGIN_PATH_1_0 of a build (meson devenv)."""

import argparse
import pathlib
import queue
import random
import subprocess
import sys
import threading

FROZEN = 30  # s


def opens(player, kind, film, count, seed):
    import gi
    gi.require_version("Gst", "1.0")
    from gi.repository import GLib, Gst
    Gst.init(None)
    if kind == "decoder":
        Gst.Registry.get().find_feature("visuotactiledecoder", Gst.ElementFactory.__gtype__).set_rank(Gst.Rank.PRIMARY + 100)
    rng = random.Random(seed)
    for n in range(count):
        play = Gst.ElementFactory.make(player)
        play.set_property("uri", pathlib.Path(film).resolve().as_uri())
        play.set_property("audio-sink", Gst.ElementFactory.make("fakesink"))
        play.set_property("video-sink", Gst.parse_bin_from_description("visuotactilesink driver=simulator video-sink=fakesink", True)
                          if kind == "sink" else Gst.ElementFactory.make("fakesink"))
        print(n, flush=True)
        play.set_state(Gst.State.PLAYING)
        GLib.usleep(rng.randrange(50_000))
        play.set_state(Gst.State.NULL)
    print("whole", flush=True)


def run(words):
    """Number of the open at which it froze, or None."""
    process = subprocess.Popen([sys.executable, __file__, "--child", *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    lines = queue.Queue()
    threading.Thread(target=read, args=(process, lines), daemon=True).start()
    at = None
    while True:
        try:
            line = lines.get(timeout=FROZEN)
        except queue.Empty:
            process.kill()
            return at
        if line == "whole":
            process.wait()
            return None
        if line == "":
            return f"{at} (status {process.wait()})"
        at = line


def read(process, lines):
    for line in process.stdout:
        lines.put(line.strip())
    lines.put("")


def main():
    if sys.argv[1:2] == ["--child"]:
        player, kind, film, count, seed = sys.argv[2:]
        opens(player, kind, film, int(count), int(seed))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("films", nargs="+", metavar="FILM")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--opens", type=int, default=300)
    parser.add_argument("--players", default="playbin,playbin3")
    parser.add_argument("--with", dest="kinds", default="none,decoder,sink")
    options = parser.parse_args()
    print(f"| film | player | with | whole runs of {options.opens} opens | frozen at open |\n|---|---|---|---|---|")
    for film in options.films:
        for player in options.players.split(","):
            for kind in options.kinds.split(","):
                ends = [run((player, kind, film, options.opens, seed)) for seed in range(options.runs)]
                frozen = ", ".join(str(at) for at in ends if at is not None)
                print(f"| {pathlib.Path(film).name} | {player} | {kind} | {ends.count(None)} of {options.runs} | {frozen or '–'} |", flush=True)


main()
