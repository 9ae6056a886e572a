#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plays a film with sound to a null sink, with visuotactiledecoder and without, in turn.

After each start, pause and seek it compares the pipeline's clock and position with the system's
time. Prints a table in Markdown. Starts a sound server of its own: PulseAudio, or PipeWire with
WirePlumber and pipewire-pulse.

Usage: pulse_clock.py [--server=pulse] [--runs=50] [--jobs=3] [--output=FILE]
    with GST_PLUGIN_PATH_1_0 as set by `meson devenv -C build`
"""
import argparse
import concurrent.futures
import contextlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

from null_sink import NullSink, appears  # noqa: E402

PLAYERS = ("playbin", "playbin3")
SERVERS = {"pulse": "PulseAudio", "pipewire": "PipeWire"}
NULL_SINK = """context.objects = [ { factory = adapter args = {
  factory.name = support.null-audio-sink node.name = null-sink media.class = Audio/Sink audio.position = "FL,FR" } } ]
"""
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


@contextlib.contextmanager
def started(env, *command, **options):
    try:
        process = subprocess.Popen(command, env=env, **options)
    except FileNotFoundError:
        sys.exit(f"there is no {command[0]}: run tools/setup.sh test")
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


@contextlib.contextmanager
def pulseaudio(work, _env):
    sink = NullSink(work)
    try:
        yield sink.socket
    finally:
        sink.stop()


@contextlib.contextmanager
def pipewire(work, env):
    """As on a desktop, with Debian's own configuration and a null sink."""
    config = pathlib.Path(work, "pipewire/pipewire.conf.d")
    config.mkdir(parents=True)
    (config / "null.conf").write_text(NULL_SINK, encoding="utf-8")
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with started(env, "dbus-daemon", "--session", "--nofork", "--print-address", stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as bus:
        env = env | {"DBUS_SESSION_BUS_ADDRESS": bus.stdout.readline().decode().strip()}
        with started(env, "pipewire", **quiet):
            appears(f"{work}/pipewire-0")
            with started(env, "wireplumber", **quiet), started(env, "pipewire-pulse", **quiet):
                yield f"{work}/pulse/native"


@contextlib.contextmanager
def sound_server(name):
    """What players need in their environment to be heard by nobody."""
    with tempfile.TemporaryDirectory() as work:
        env = os.environ | {key: work for key in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME", "HOME")}
        with {"pulse": pulseaudio, "pipewire": pipewire}[name](work, env) as socket:
            appears(socket)
            env = os.environ | {"PULSE_SERVER": f"unix:{socket}", "XDG_RUNTIME_DIR": work}
            deadline = now() + 20
            while subprocess.run("gst-launch-1.0 -q audiotestsrc num-buffers=1 ! pulsesink".split(), env=env, capture_output=True).returncode:
                if now() > deadline:
                    sys.exit(f"{SERVERS[name]} plays nothing within 20 s")
            yield env


def table(options, results):
    server, runs = SERVERS[options.server], options.runs
    yield f"# Clock and position with {server}"
    yield ""
    yield f"Made by `tests/tools/pulse_clock.py --server={options.server} --output=docs/measured/{options.server}.md`; do not edit."
    yield ""
    yield f"{runs} runs each of a film with sound to {server}'s null sink: start, two pauses, a seek. After each, the"
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
    parser.add_argument("--server", choices=SERVERS, default="pulse")
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=3)
    parser.add_argument("--output")
    parser.add_argument("--play", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.play:
        return play(*options.play)
    with tempfile.TemporaryDirectory() as work, sound_server(options.server) as env:
        film = f"{work}/film.mkv"
        subprocess.run(["gst-launch-1.0", "-q", *"matroskamux name=mux ! filesink".split(), f"location={film}",
                        *"videotestsrc num-buffers=360 pattern=ball ! video/x-raw,width=320,height=240 ! vp8enc deadline=1 ! queue ! mux.".split(),
                        *"audiotestsrc num-buffers=517 ! audioconvert ! vorbisenc ! queue ! mux.".split()], check=True)
        asked = [(player, felt) for _ in range(options.runs) for player in PLAYERS for felt in (False, True)]
        results = {(player, felt): [] for player in PLAYERS for felt in (False, True)}
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            for done, (key, said) in enumerate(zip(asked, pool.map(lambda key: run(*key, film, env), asked)), 1):
                results[key].append(said)
                awry = {after: by for after, by in said.get("ahead", {}).items() if max(map(abs, by)) > AWRY}
                if awry or "fault" in said:
                    print(*key, said.get("fault", awry), file=sys.stderr)
                print(f"run {done} of {len(asked)}", end="\r", file=sys.stderr)
    text = "\n".join(table(options, results)) + "\n"
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
