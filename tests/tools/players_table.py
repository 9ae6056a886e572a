#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes docs/measured/players.md: players with visuotactiledecoder switched on and off.

Each player runs on an Xvfb of its own, as its Debian package installed it, and is told to pause,
seek and go on by its own means. playerwatch, a tracer of GStreamer, writes down its frames.

Usage: players_table.py [--turns=3] [--server=pulse] [--output=FILE] [--build=build] [--pictures=FOLDER --film=FILE] [PLAYER ...]
    --pictures   instead plays FILE in each player that is switched on, and writes a picture of the screen
    PLAYER       some of the players, as in the table
"""
import argparse
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

import pulse_clock
from players_known import HERE, LIMIT, RATE, Missing, Uri, players
from players_watched import FILM, NEXT_FILM, SECOND, epochs, frames, matched, moves, not_at_zero, screen, shape, usage, watched

FRAME_RATE = 30
MOST_PAUSED = 1  # frames that may still come
CHECKS = ("felt", "picture", "pause", "seek", "rate", "track", "next film", "end", "sound only", "killed")


def wait(player, done, what):
    deadline = time.monotonic() + LIMIT
    while not done():
        if time.monotonic() > deadline:
            raise Missing(f"{what}: not within {LIMIT} s")
        if player.process.poll() is not None and not done():
            raise Missing(f"{what}: it ended with status {player.process.returncode}")
        time.sleep(0.05)


def check_pause(player, folder, _film):
    player.say("pause", None)
    time.sleep(0.4)
    before = len(frames(folder))
    time.sleep(1)
    more = len(frames(folder)) - before
    player.say("resume", None)
    wait(player, lambda: len(frames(folder)) > before + FRAME_RATE // 2, "it does not go on")
    if more > MOST_PAUSED:
        raise Missing(f"{more} frames in a pause")


def check_seek(player, folder, film):
    position, known = frames(folder)[-1].film, len(frames(folder))
    player.say("seek", film)
    wait(player, lambda: any(frame.film < position - SECOND // 2 for frame in frames(folder)[known:]), "no earlier frame")
    wait(player, lambda: len(frames(folder)) > known + FRAME_RATE, "it does not go on")


def check_rate(player, folder, _film):
    player.say("rate", None)

    def is_reached():
        first, *_, last = frames(folder)[-FRAME_RATE:]
        return last.shown > first.shown and abs((last.film - first.film) / (last.shown - first.shown) / RATE - 1) < 0.02

    wait(player, is_reached, f"not {RATE} times as fast")


def check_track(player, folder, _film):
    known = len(frames(folder))
    player.say("track", None)
    wait(player, lambda: len(frames(folder)) > known + FRAME_RATE, "it does not go on")


def ended(folder, film):
    return any(line.kind == "eos" and shape(line) == film for line in watched(folder))


def check_next(player, folder, film):
    if "next" in player.controls:
        wait(player, lambda: ended(folder, FILM), "no end of the first film")
        player.say("next", film)
    wait(player, lambda: len(frames(folder, NEXT_FILM)) > 3 * FRAME_RATE, "too few frames of it")
    if "pause" in player.controls:  # in which tactorsink writes its trace
        player.say("pause", None)
        time.sleep(0.4)
        player.say("resume", None)


def run_check(cells, name, check, *arguments):
    try:
        cells[name] = check(*arguments) or "yes"
    except Missing as missing:
        cells[name] = f"no: {missing}"


def watch_play(player, films, env, folder):
    cells = {}
    try:
        wait(player, lambda: len(frames(folder)) > 2 * FRAME_RATE, "no frame")
    except Missing as missing:
        return {"cells": dict.fromkeys(CHECKS, f"no: {missing}")}
    begin = time.monotonic(), usage(player.process.pid)[0]
    cells["picture"] = "yes" if moves(env, folder) else "no: the screen does not change"
    for name, check in (("pause", check_pause), ("seek", check_seek), ("track", check_track), ("rate", check_rate)):
        if name in player.controls:
            run_check(cells, name, check, player, folder, films[1])
        else:
            cells[name] = "–"
    several = not isinstance(player, Uri)
    if several:
        run_check(cells, "next film", check_next, player, folder, films[1])
    else:
        cells["next film"] = "–"
        run_check({}, "end", wait, player, lambda: frames(folder)[-1].film > 10 * SECOND, "no end")
    cpu, memory = usage(player.process.pid)
    measured = {"cpu": (cpu - begin[1]) / (time.monotonic() - begin[0]), "memory": memory}
    last = NEXT_FILM if several and not cells["next film"].startswith("no") else FILM
    run_check(cells, "end", wait, player, lambda: ended(folder, last), "no end")
    time.sleep(0.5)  # the last frame is still shown when the end reaches the sink
    return {"cells": cells, **measured}


def watch_sound(player, _films, _env, folder):
    cells = {}
    run_check(cells, "sound only", wait, player, lambda: any(line.kind == "eos" for line in watched(folder)), "no end")
    return cells


def watch_kill(server):
    """SIGKILL, when a motor of the vest that `server` plays is on."""
    def watch(player, _films, _env, folder):
        cells = {}
        try:
            wait(player, lambda: len(frames(folder)) > FRAME_RATE and server.is_on(), "no motor is on")
        except Missing as missing:
            return {"killed": f"no: {missing}"}
        os.killpg(player.process.pid, signal.SIGKILL)
        player.process.wait()
        run_check(cells, "killed", server.wait_for_silence)
        return cells
    return watch


class Vest:
    """A bHaptics Player for tests, which stops a motor when its command's duration is over."""

    def __enter__(self):
        server = HERE.parent / "support" / "haptic_server.py"
        self.process = subprocess.Popen(["/usr/bin/python3", server, "bhaptics"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline().split()[1])
        self.last = ""
        self.reader = threading.Thread(target=self.read)
        self.reader.start()
        return self

    def read(self):
        for line in self.process.stdout:
            if line.startswith(("motors", "expired")):
                self.last = line

    def is_on(self):
        return "=" in self.last

    def wait_for_silence(self):
        deadline = time.monotonic() + 1
        while self.is_on():
            if time.monotonic() > deadline:
                raise Missing("motors are on a second later")
            time.sleep(0.01)

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.reader.join()


def felt(folder, cells):
    """Whether it was, in each part of the play, and the errors of the commands in ms."""
    pairs = matched(folder)
    errors = [(command.issued + command.effect - command.due - frame.shown) / 1e6 for command, frame in pairs]
    parts = epochs([frame for _, frame in pairs], lambda frame: frame.shown)
    lacks = []
    if len(pairs) < 10:
        lacks.append(f"{len(pairs)} commands")
    elif cells.get("seek") == "yes" and len(parts) < 2:
        lacks.append("nothing after the seek")
    elif cells.get("next film") == "yes" and not any(shape(frame) == NEXT_FILM for _, frame in pairs):
        lacks.append("nothing of the next film")
    left = not_at_zero(folder)
    if left:
        lacks.append(f"{left} tactors are left on")
    return "no: " + ", ".join(lacks) if lacks else "yes", errors


class Display:
    """An Xvfb."""

    def __enter__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-noreset", "-nolisten", "tcp", "-screen", "0", "800x600x24"],
                                       pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            return f":{number.readline().strip()}"

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()


class Bus:
    """A D-Bus for one player."""

    def __enter__(self):
        self.daemon = subprocess.Popen(["dbus-daemon", "--session", "--nofork", "--print-address"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        return self.daemon.stdout.readline().decode().strip()

    def __exit__(self, *_):
        self.daemon.terminate()
        self.daemon.wait()


def environment(options, sound, folder, display, bus, chair, player):
    own = {key: str(folder) for key in ("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "PLAYERWATCH")}
    env = sound | own | {
        "DISPLAY": display, "DBUS_SESSION_BUS_ADDRESS": bus, "GDK_BACKEND": "x11", "LIBGL_ALWAYS_SOFTWARE": "1", "NO_AT_BRIDGE": "1", "TERM": "xterm",
        "GST_TRACERS": "playerwatch", "GST_PLUGIN_PATH_1_0": f"{options.build}/gst:{options.build}/tests/tools",
        "GST_REGISTRY_1_0": f"{options.work}/{'on' if chair else 'off'}.registry"}
    env.pop("WAYLAND_DISPLAY", None)
    if chair:
        for arguments in (["on", player.program], ["set", *chair]):
            subprocess.run([options.build / "tools/visuotactile-settings", *arguments], env=env, check=True, stdout=subprocess.DEVNULL)
    return env


def play(options, sound, player, chair, films, watch):
    """watch(player, films, env, folder) while it plays with such settings of the chair, or without one."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=options.work))
    with Display() as display, Bus() as bus, open(folder / "log", "wb") as log:
        env = environment(options, sound, folder, display, bus, chair, player)
        player.start(films, env, log)
        try:
            result = watch(player, films, env, folder)
        finally:
            player.stop()
    return result, folder


def measure(options, sound, player, switched_on, films):
    sounds = [films[0].with_name("sound.m4a")] * 3
    if "track" not in player.controls:
        films = [films[0].with_name("one-track.mp4"), *films[1:]]
    chair = ["driver=simulator"] if switched_on else []
    other_plays, folder = play(options, sound, player, chair, sounds, watch_sound)
    shutil.rmtree(folder)
    if switched_on:
        with Vest() as vest:
            killed, folder = play(options, sound, player, ["driver=bhaptics", f"device=vest-back@127.0.0.1:{vest.port}"], films, watch_kill(vest))
        shutil.rmtree(folder)
        other_plays |= killed
    else:
        other_plays["killed"] = ""
    result, folder = play(options, sound, player, chair, films, watch_play)
    cells = result["cells"] = result["cells"] | other_plays
    if switched_on:
        cells["felt"], result["errors"] = felt(folder, cells)
    else:
        cells["felt"] = "no" if not list(folder.glob("commands-*.csv")) else "yes"
    if any(cell.startswith("no:") for cell in cells.values()) and options.keep:
        print(f"  {folder}", file=sys.stderr)
    elif not options.keep:
        shutil.rmtree(folder)
    return result


# ---- the page ----------------------------------------------------------------------------------


def sound_of(frames_of, frequency):
    return (f"audiotestsrc volume=0.1 freq={frequency} samplesperbuffer={44100 // FRAME_RATE} num-buffers={frames_of} ! "
            "audio/x-raw,rate=44100,channels=1 ! avenc_aac")


def make_sound(path, seconds):
    subprocess.run(["gst-launch-1.0", "-q", *f"{sound_of(seconds * FRAME_RATE, 440)} ! mp4mux ! filesink location={path}".split()], check=True)


def make_film(path, width, seconds, sounds=(440, 660)):
    frames_of = seconds * FRAME_RATE
    line = (f"mp4mux name=mux ! filesink location={path} "
            f"tactiletestsrc pattern=dynamic-motion seed=4 num-buffers={frames_of} ! video/x-raw,format=I420,width={width},height=360,framerate={FRAME_RATE}/1 ! "
            "x264enc speed-preset=ultrafast key-int-max=15 ! queue ! mux. "
            + " ".join(f"{sound_of(frames_of, frequency)} ! queue ! mux." for frequency in sounds))
    subprocess.run(["gst-launch-1.0", "-q", *line.split()], check=True)


def cell(said):
    """What the turns say of a check."""
    if len(set(said)) == 1:
        return said[0]
    good = [one for one in said if not one.startswith("no")]
    return f"{len(good)} of {len(said)}; {next(one for one in said if one.startswith('no'))}"


def percentile(values, part):
    return sorted(values)[int(part * (len(values) - 1))]


def table(options, results):
    yield "# Players"
    yield ""
    yield f"Made by `tests/tools/players_table.py --turns={options.turns} --output=docs/measured/players.md`; do not edit."
    yield ""
    debian = pathlib.Path("/etc/debian_version").read_text(encoding="utf-8").strip()
    yield f"{machine()}, Debian {debian}, GStreamer {gstreamer()}, Xvfb, {pulse_clock.SERVERS[options.server]}'s null sink,"
    yield f"load average meanwhile {min(options.loads):.1f} to {max(options.loads):.1f}."
    yield ""
    yield f"Each player plays two films with sound, H.264 at 640×360 and 480×360, 30 frames/s, {options.turns} times each with visuotactiledecoder"
    yield "disabled and enabled in turns, and before that a file with sound only, to its end. The test pauses and seeks it with its"
    yield "own controls: keys, command line, MPRIS, or calls of a script or page. –: it has no such control."
    yield ""
    yield "- Felt: at least ten commands for shown frames, also after the seek and in the next film; all motors end at zero."
    yield "- Picture: the screen moves. Pause: no frame is shown for a second, then they go on. Seek: earlier frames are shown."
    yield f"- Rate: {RATE} times as fast, until the film's end. Track: another sound track plays, and the picture continues."
    yield "- Sound only: its end reaches the sink. Killed: SIGKILL in another play, on a vest of bHaptics' protocol, whose motors are off a"
    yield "  second later."
    yield "- Next film: its frames are shown. End: the end of the stream reaches the sink."
    yield "- Error: the time at which the motor reaches its level (issue of the command + lead), minus the time at which the video sink begins to show"
    yield "  the command's frame. p50 with its sign, p95 of its magnitude."
    yield ""
    yield "| player | decoder | " + " | ".join(CHECKS) + " | commands | error p50 | p95 |"
    yield "|---|---|" + "---|" * len(CHECKS) + "---|---|---|"
    for (label, switched_on), turns in results.items():
        errors = [error for turn in turns for error in turn.get("errors", ())]
        shown = [f"{len(errors)}", f"{statistics.median(errors):+.2f} ms", f"{percentile(list(map(abs, errors)), 0.95):.2f} ms"] if errors else ["", "", ""]
        yield "| " + " | ".join([label, "on" if switched_on else "off", *(cell([turn["cells"].get(check, "no") for turn in turns]) for check in CHECKS), *shown]) + " |"
    yield ""
    yield "## CPU and memory"
    yield ""
    yield "The table has the player with its child processes. CPU: share of one core from two seconds after the start to the next film, on a software"
    yield f"renderer. Memory: PSS then. Medians of {options.turns}. Plays with a failed check are included: a film that stands"
    yield "still takes less."
    yield ""
    yield "| player | CPU, off | on | memory, off | on |"
    yield "|---|---|---|---|---|"
    for label in dict.fromkeys(label for label, _ in results):
        values = [[turn[key] for turn in results[label, switched_on] if key in turn] for key in ("cpu", "memory") for switched_on in (False, True)]
        if all(values):
            cpu_off, cpu_on, memory_off, memory_on = map(statistics.median, values)
            yield f"| {label} | {100 * cpu_off:.0f} % | {100 * cpu_on:.0f} % | {memory_off:.0f} MB | {memory_on:.0f} MB |"


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        model = next(line.partition(":")[2].strip() for line in file if line.startswith("model name"))
    return f"{model}, {os.cpu_count()} CPUs"


def gstreamer():
    said = subprocess.run(["gst-launch-1.0", "--version"], capture_output=True, text=True, check=True).stdout
    return next(line.split()[1] for line in said.splitlines() if line.startswith("GStreamer "))


def picture(player, films, env, folder):
    wait(player, lambda: any(line.kind == "frame" and line.film > 4.5 * SECOND for line in watched(folder)), "no frame")
    screen(env, folder / "screen.jpg", "videoconvert ! videoscale method=lanczos ! video/x-raw,width=640,height=480 ! jpegenc quality=50")


def take_pictures(options, sound, chosen):
    for player in chosen:
        name = player.label.lower().split()[0].strip(",")
        _, folder = play(options, sound, player, ["driver=simulator"], [options.film] * 3, picture)
        options.pictures.mkdir(parents=True, exist_ok=True)
        shutil.copy(folder / "screen.jpg", options.pictures / f"{name}.jpg")
        print(f"{player.label}: {name}.jpg", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--server", choices=pulse_clock.SERVERS, default="pulse")
    parser.add_argument("--output", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent.parent / "build")
    parser.add_argument("--pictures", type=pathlib.Path)
    parser.add_argument("--film", type=pathlib.Path)
    parser.add_argument("--keep", action="store_true", help="keep what each player wrote")
    parser.add_argument("player", nargs="*")
    options = parser.parse_args()
    options.build = options.build.resolve()
    chosen = [player for player in players() if not options.player or player.label in options.player]
    if not chosen:
        parser.error(f"expected players of {', '.join(player.label for player in players())}, got {', '.join(options.player)}")
    if bool(options.pictures) != bool(options.film):
        parser.error("--pictures and --film go together")
    if not (options.build / "tests/tools/libgstplayerwatch.so").exists():
        parser.error(f"expected a finished build in {options.build}: ninja -C {options.build}")
    os.environ["GST_PLUGIN_PATH_1_0"] = str(options.build / "gst")
    options.loads = []
    options.work = pathlib.Path(tempfile.mkdtemp())
    try:
        with pulse_clock.sound_server(options.server) as sound:
            if options.pictures:
                options.film = options.film.resolve()
                return take_pictures(options, sound, chosen)
            films = [options.work / "film.mp4", options.work / "next.mp4", options.work / "beside.mp4"]
            make_film(films[0], 640, 12)
            make_film(options.work / "one-track.mp4", 640, 12, sounds=(440,))
            make_film(films[1], 480, 4)
            make_film(films[2], 360, 12)
            make_sound(options.work / "sound.m4a", 2)
            results = {}
            for turn in range(options.turns):
                for player in chosen:
                    for switched_on in (False, True):
                        result = measure(options, sound, player, switched_on, films)
                        options.loads.append(os.getloadavg()[0])
                        results.setdefault((player.label, switched_on), []).append(result)
                        print(f"turn {turn + 1}, {player.label}, {'on' if switched_on else 'off'}: {result['cells']}", file=sys.stderr)
    finally:
        if not options.keep:
            shutil.rmtree(options.work)
    # A player's rows stay together.
    ordered = {(player.label, switched_on): results[player.label, switched_on] for player in chosen for switched_on in (False, True)}
    text = "\n".join(table(options, ordered)) + "\n"
    if options.output:
        options.output.write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
