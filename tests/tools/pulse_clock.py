#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plays a film with sound to PulseAudio's null sink, with visuotactiledecoder and without, in turn.

After each start, pause and seek it compares the pipeline's clock and position with the system's
time. Prints a table in Markdown. Starts a PulseAudio server of its own.

Usage: pulse_clock.py [--runs=50] [--jobs=3] [--output=FILE]
    with GST_PLUGIN_PATH_1_0 as set by `meson devenv -C build`
"""
import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile
import time

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

PLAYERS = ("playbin", "playbin3")
SETTLED = 0.3  # s after a change
WATCHED = 1.2  # s
PAUSED = 0.7  # s
AWRY = 0.15  # s: a clock or a position that is off by more within WATCHED stands or runs away


def now():
    return time.monotonic()


def reached(player, state):
    player.set_state(state)
    if player.get_state(10 * Gst.SECOND)[0] != Gst.StateChangeReturn.SUCCESS:
        raise RuntimeError(f"{state.value_nick} is not reached within 10 s")


def watch(player):
    """Seconds that clock and position are ahead of the system's time after WATCHED."""
    time.sleep(SETTLED)
    clock = player.get_clock()
    begin = now(), clock.get_time(), player.query_position(Gst.Format.TIME)[1]
    time.sleep(WATCHED)
    end = now(), clock.get_time(), player.query_position(Gst.Format.TIME)[1]
    passed = end[0] - begin[0]
    return [(end[i] - begin[i]) / Gst.SECOND - passed for i in (1, 2)]


def play(name, film):
    Gst.init(None)
    player = Gst.ElementFactory.make(name)
    player.set_property("uri", Gst.filename_to_uri(film))
    player.set_property("video-sink", Gst.ElementFactory.make("fakevideosink"))
    player.set_property("audio-sink", Gst.ElementFactory.make("pulsesink"))
    decoders = []
    player.connect("deep-element-added", lambda _player, _bin, element: decoders.append(element.get_factory().get_name()))
    reached(player, Gst.State.PLAYING)
    ahead = {"start": watch(player)}
    for pause in ("first pause", "second pause"):
        reached(player, Gst.State.PAUSED)
        time.sleep(PAUSED)
        reached(player, Gst.State.PLAYING)
        ahead[pause] = watch(player)
    player.seek_simple(Gst.Format.TIME, Gst.SeekFlags.FLUSH | Gst.SeekFlags.KEY_UNIT, 2 * Gst.SECOND)
    player.get_state(10 * Gst.SECOND)
    ahead["seek"] = watch(player)
    clock = player.get_clock().get_name()
    player.set_state(Gst.State.NULL)
    print(json.dumps({"felt": "visuotactiledecoder" in decoders, "clock": clock, "ahead": ahead}))


def run(player, felt, film, env):
    rank = "MAX" if felt else "NONE"
    one = subprocess.run([sys.executable, __file__, "--play", player, film], env=env | {"GST_PLUGIN_FEATURE_RANK": f"visuotactiledecoder:{rank}"},
                         capture_output=True, text=True, timeout=120)
    if one.returncode:
        return {"fault": one.stderr.strip().splitlines()[-1:]}
    said = json.loads(one.stdout.splitlines()[-1])
    if said["felt"] != felt:
        raise RuntimeError(f"visuotactiledecoder: expected {felt}, got {said['felt']}; is GST_PLUGIN_PATH_1_0 set?")
    return said


def table(runs, results):
    yield "# Clock and position with PulseAudio"
    yield ""
    yield "Made by `tests/tools/pulse_clock.py --output=docs/measured/pulse.md`; do not edit."
    yield ""
    yield f"{runs} runs each of a film with sound to PulseAudio's null sink: start, two pauses, a seek. After each, the"
    yield f"pipeline's clock and position are compared with the system's time for {WATCHED} s. Stands: the clock falls behind by"
    yield f"more than {AWRY} s. Runs away: it gets ahead by as much. Apart: the position is that far from the clock."
    yield ""
    yield "| player | video decoder | stands after the start | after a pause | after a seek | longest, s | runs away | apart | errors |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for (player, felt), said in results.items():
        whole = [one["ahead"] for one in said if "ahead" in one]
        stands = [sum(any(by[0] < -AWRY for key, by in one.items() if after in key) for one in whole) for after in ("start", "pause", "seek")]
        every = [by for one in whole for by in one.values()]
        yield "| " + " | ".join([
            player, "visuotactiledecoder" if felt else "the usual", *map(str, stands), f"{max(0, *(-clock for clock, _ in every)):.2f}",
            str(sum(clock > AWRY for clock, _ in every)), str(sum(abs(position - clock) > AWRY for clock, position in every)),
            str(len(said) - len(whole))]) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=3)
    parser.add_argument("--output")
    parser.add_argument("--play", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.play:
        return play(*options.play)
    with tempfile.TemporaryDirectory() as work:
        film = f"{work}/film.mkv"
        subprocess.run(["gst-launch-1.0", "-q", *"matroskamux name=mux ! filesink".split(), f"location={film}",
                        *"videotestsrc num-buffers=360 pattern=ball ! video/x-raw,width=320,height=240 ! vp8enc deadline=1 ! queue ! mux.".split(),
                        *"audiotestsrc num-buffers=517 ! audioconvert ! vorbisenc ! queue ! mux.".split()], check=True)
        server = subprocess.Popen(["pulseaudio", "-n", "--daemonize=no", "--exit-idle-time=-1", "--use-pid-file=no", "--log-level=error",
                                   "--load=module-null-sink", f"--load=module-native-protocol-unix socket={work}/socket auth-anonymous=1"],
                                  env=os.environ | {"XDG_RUNTIME_DIR": work, "HOME": work})
        try:
            deadline = now() + 20
            while not os.path.exists(f"{work}/socket"):
                if server.poll() is not None or now() > deadline:
                    sys.exit("PulseAudio does not start: expected the Debian package pulseaudio")
                time.sleep(0.05)
            env = os.environ | {"PULSE_SERVER": f"unix:{work}/socket", "XDG_RUNTIME_DIR": work}
            asked = [(player, felt) for _ in range(options.runs) for player in PLAYERS for felt in (False, True)]
            results = {(player, felt): [] for player in PLAYERS for felt in (False, True)}
            with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
                for done, (key, said) in enumerate(zip(asked, pool.map(lambda key: run(*key, film, env), asked)), 1):
                    results[key].append(said)
                    awry = {after: by for after, by in said.get("ahead", {}).items() if max(map(abs, by)) > AWRY}
                    if awry or "fault" in said:
                        print(*key, said.get("fault", awry), file=sys.stderr)
                    print(f"run {done} of {len(asked)}", end="\r", file=sys.stderr)
        finally:
            server.terminate()
            server.wait()
    text = "\n".join(table(options.runs, results)) + "\n"
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
