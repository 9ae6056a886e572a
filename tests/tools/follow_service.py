#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What visuotactile-follow does around a player: where it finds tracks, drafts that it makes, its status and its nudge, how it is started by the
session, and its ways out: a locked screen, a computer that goes to sleep, a session bus that is gone. logind is dbusmock's.

Expects what follow_stage.py does, TRACK, SESSION (the folder of the services' files), systemd-analyze and python3-dbusmock.
Usage: follow_service.py [PART ...]      of drafts, embedded, uneven, library, faulty, status, wakings, activation, ways_out; all by default"""

import contextlib
import functools
import http.server
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import threading
import time

import dbus
import dbusmock
import follow_trace
from follow_stage import FOLLOW, LATEST, NAME, PATH, Follower, Mpv, make_film, make_track, run, session, start, start_bus, vest, wait_until, work

TRACK = os.environ["TRACK"]
LOGIND = "org.freedesktop.login1"


def track(*words):
    return subprocess.run([TRACK, *words], capture_output=True, text=True, check=False, timeout=LATEST)


def drafts():
    """From the middle on, then the rest; the same draft as tactile-track author makes at once."""
    film = make_film("drafted.mkv", 30)
    mpv = Mpv(film, "--start=20", "--loop")
    follower = Follower(mpv, "--sound=film")  # of a film that has none
    follower.wait_for("plays 'drafted.mkv' with a draft that is made while it plays")
    vest.wait_to_feel()
    follower.wait_for("is complete, and kept for the next time")
    mpv.command("seek", 3, "absolute")
    vest.wait_to_feel()
    follower.end()
    assert [file.name for file in film.parent.iterdir()] == ["drafted.mkv"], "something was written beside the film"
    kept = list((work / "cache/visuotactile/drafts").iterdir())
    assert len(kept) == 1, kept
    at_once = work / "at-once.vtt"
    assert track("author", "-q", str(film), "-o", str(at_once)).returncode == 0
    same_films(at_once, kept[0])
    # The next time, and under another name.
    other = film.with_name("renamed.mkv")
    film.rename(other)
    mpv.command("loadfile", str(other))
    follower = Follower(mpv)
    follower.wait_for("plays 'renamed.mkv' with a draft of an earlier time")
    vest.wait_to_feel()
    follower.end()
    mpv.quit()
    # With sound, from the middle on.
    impacts = other.with_name("impacts.mkv")
    subprocess.run(f"gst-launch-1.0 -q matroskamux name=m ! filesink location={impacts} filesrc location={other} ! matroskademux ! h264parse ! m. "
                   "tactilesoundtestsrc num-buffers=1500 ! audio/x-raw,rate=48000 ! audioconvert ! flacenc ! m.".split(), check=True)
    mpv = Mpv(impacts, "--start=20", "--loop")
    follower = Follower(mpv, "--sound=film")
    follower.wait_for("is complete, and kept for the next time")
    follower.end()
    mpv.quit()
    assert len(list((work / "cache/visuotactile/drafts").iterdir())) == 2
    # In a transport stream, which counts from a clock, the same pictures have the same draft.
    earlier = set((work / "cache/visuotactile/drafts").iterdir())
    short, clocked = (other.with_name(name) for name in ("short.mkv", "clocked.ts"))
    for name in (short, clocked):
        subprocess.run(["ffmpeg", "-v", "error", "-t", "6", "-i", str(other), "-c", "copy", str(name)], check=True)
    mpv = Mpv(clocked, "--loop")
    follower = Follower(mpv)
    follower.wait_for("the draft of 'clocked.ts' is complete")
    follower.end()
    mpv.quit()
    kept, = set((work / "cache/visuotactile/drafts").iterdir()) - earlier
    assert track("author", "-q", str(short), "-o", str(at_once), "-f").returncode == 0
    same_films(at_once, kept)
    shutil.rmtree(film.parent)


def cues(path):
    """(begin, end, percents) of a track's cues that are felt, in ms."""
    found = []
    for block in path.read_text(encoding="utf-8").split("\n\n"):
        lines = block.strip().split("\n")
        if " --> " in lines[0]:
            begin, end = (sum(float(part) * scale for part, scale in zip(time.split(":"), (3600e3, 60e3, 1e3))) for time in lines[0].split(" --> "))
            found.append((begin, end, [int(word) for line in lines[1:] for word in line.split()]))
    return found


def level_at(found, at):
    return next((levels for begin, end, levels in found if begin <= at < end), [0] * 9)


def same_films(expected, got):
    """The analysis adapts to what it saw before, so that a draft from the middle on differs a little for a while."""
    one, other = cues(expected), cues(got)
    assert one[-1][1] == other[-1][1] or abs(one[-1][1] - other[-1][1]) < 1000, (one[-1], other[-1])
    off = [abs(a - b) for at in range(0, 30000, 100) for a, b in zip(level_at(one, at), level_at(other, at))]
    mean = sum(off) / len(off)
    print(f"levels differ by {mean:.1f} % on average")
    felt = sum(sum(level_at(one, at)) for at in range(0, 30000, 100)) / len(off)
    assert mean < felt / 3, (mean, felt)


def embedded():
    """Films that show nothing, with pulses in their files."""
    black = make_film("black.mkv", 12, pattern=None)
    pulses = work / "pulses" / "pulses.csv"
    make_track(pulses, 12)
    for ending in ("mkv", "mp4", "ts"):
        carrier = black.with_name(f"carrier.{ending}")
        muxed = track("mux", "-q", str(black), str(pulses), "-o", str(carrier))
        assert muxed.returncode in (0, 3), muxed  # 3: names that the container cannot hold
        mpv = Mpv(carrier, "--start=9", "--pause")
        follower = Follower(mpv, "--no-drafts")
        follower.wait_for(f"plays 'carrier.{ending}' with the track in its file")
        # Until it plays, others may have the vest.
        assert "state:    paused" in ask("--status")
        begin = time.monotonic()
        mpv.command("set_property", "pause", False)
        vest.wait_to_feel()
        assert vest.opened[-1] > begin, "the vest was taken by a film that did not play"
        # The film ends.
        mpv.process.wait(LATEST)
        wait_until("silence", vest.is_silent)
        follower.end()
        carrier.unlink()
    # One that promises a track and has none: subtitles named like it.
    words = work / "words.srt"
    words.write_text("1\n00:00:01,000 --> 00:00:03,000\nHello!\n", encoding="utf-8")
    subprocess.run(["ffmpeg", "-v", "error", "-i", str(black), "-i", str(words), "-c:v", "copy", "-c:s", "srt", "-metadata:s:s:0", "title=Tactile",
                    str(black.with_name("words.mkv"))], check=True)
    mpv = Mpv(black.with_name("words.mkv"))
    follower = Follower(mpv, "--no-drafts")
    follower.wait_for("no track for 'words.mkv'")
    follower.end()
    mpv.quit()
    shutil.rmtree(black.parent)


def uneven():
    """Frames that are up to 0.6 s apart. Each pulse is felt once, as far from the first as in the track."""
    film, trace = work / "films" / "uneven.mkv", work / "uneven.csv"
    film.parent.mkdir(exist_ok=True)
    subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc2=size=160x120:rate=25:duration=8", "-vf", "select='lt(t,1.5)+gt(t,6)+not(mod(n,15))'",
                    "-vsync", "vfr", "-c:v", "libx264", "-preset", "ultrafast", str(film)], check=True)
    pulses = [(2, 0.7), (3, 0.7), (4, 0.7), (5, 0.7), (6, 0.7)]
    follow_trace.make_track(film.with_suffix(".csv"), pulses, 8)
    mpv = Mpv(film, "--pause")
    with open(work / "log", "w", encoding="utf-8") as log:
        follower = start(FOLLOW, f"--mpv={mpv.path}", "--driver=simulator", f"--trace={trace}", "--no-drafts", stderr=log)
    wait_until("the track", lambda: "plays 'uneven.mkv' with" in (work / "log").read_text(encoding="utf-8"))
    mpv.command("set_property", "pause", False)
    mpv.process.wait(LATEST)
    follower.send_signal(signal.SIGINT)
    assert follower.wait(LATEST) == 0
    felt = follow_trace.onsets(follow_trace.read_trace(trace))
    assert len(felt) == len(pulses), f"{len(felt)} onsets at {felt}, expected {len(pulses)}"
    off = [at - felt[0] - (second - pulses[0][0]) for at, (second, _) in zip(felt, pulses)]
    assert max(map(abs, off)) < 0.2, f"off by {off} s"
    shutil.rmtree(film.parent)


def library():
    """By words of the name and the film's duration."""
    film = make_film("Bouncing.Balls.2012.1080p.mkv", 12, pattern=None)
    refused = subprocess.run([FOLLOW, f"--tracks={film}"], capture_output=True, text=True, check=False, timeout=LATEST)
    assert refused.returncode == 1 and "is not a folder" in refused.stderr, refused
    mpv = Mpv(film)
    make_track(work / "tracks" / "bouncing balls 2012.csv", 30)  # another film's
    make_track(work / "tracks" / "seven balls.csv", 12)
    make_track(work / "tracks" / "balls.csv", 12)
    make_track(work / "tracks" / "Bouncing Balls.csv", 12)
    follower = Follower(mpv, f"--tracks={work}/tracks")
    follower.wait_for(f"with '{work}/tracks/Bouncing Balls.csv'")
    vest.wait_to_feel()
    follower.end()
    # The same library on a web server.
    index = {"tracks": [{"file": "Bouncing Balls.csv", "duration": 12}]}
    (work / "tracks" / "tracks.json").write_text(json.dumps(index), encoding="utf-8")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=work / "tracks")
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}"
    follower = Follower(mpv, f"--tracks={address}")
    follower.wait_for(f"with '{address}/Bouncing%20Balls.csv'")
    vest.wait_to_feel()
    follower.end()
    server.shutdown()
    mpv.quit()
    shutil.rmtree(film.parent)


def faulty():
    """A track of one's own that is faulty: it is said, nothing is felt, and no draft takes its place until that is asked for. A mended one is felt at once."""
    film = make_film("faulty.mkv", 30)
    own = film.with_suffix(".csv")
    faults = {own: ("# tactile grid=1x1 rate=5\ntime_ms,t0\n1000,1\n700,0\n", "line 4"),
              film.with_suffix(".vtt"): ("WEBVTT\n\nNOTE tactile grid=1x1\n\n00:02.000 --> 00:03.000\n100\n\n00:01.000 --> 00:01.500\n100\n", "line 8: the cue is out of order")}
    bus = dbus.SessionBus(private=True)
    for path, (text, where) in faults.items():
        path.write_text(text, encoding="utf-8")
        mpv = Mpv(film, "--loop")
        follower = Follower(mpv)
        follower.wait_for("nothing is felt of 'faulty.mkv': its track is faulty")
        said = ask("--status")
        assert re.search("state:    (plays|waits)", said) and f"fault:    '{path}': {where}" in said and "track:" not in said, said
        properties = bus.get_object(NAME, PATH).GetAll(NAME, dbus_interface="org.freedesktop.DBus.Properties")
        assert where in properties["Fault"] and properties["Track"] == "", properties
        # Somebody mends it.
        path.write_text("WEBVTT\n\nNOTE tactile grid=1x1\n\n00:00.000 --> 00:30.000\n100\n" if path.suffix == ".vtt" else text.replace("700,", "1700,"), encoding="utf-8")
        follower.wait_for(f"plays 'faulty.mkv' with '{path}'")
        assert "fault:" not in ask("--status")
        if path.suffix == ".vtt":
            vest.wait_to_feel()
        assert "draft" not in follower.said(), follower.said()
        follower.end()
        mpv.quit()
        # Or wants something else.
        path.write_text(text, encoding="utf-8")
        mpv = Mpv(film, "--loop")
        follower = Follower(mpv)
        follower.wait_for("its track is faulty")
        ask("--pass-over")
        follower.wait_for("plays 'faulty.mkv' with a draft")
        assert "fault:" not in ask("--status")
        assert "no faulty track to skip" in ask("--pass-over", status=1)
        follower.end()
        mpv.quit()
        path.unlink()
    # In the film's file.
    own, carrier = work / "own.srt", film.with_name("carrier.mkv")
    cue = lambda begin, text: f"1\n00:00:0{begin},000 --> 00:00:0{begin},900\n{text}\n\n"
    for text, where in (("101", "the cue at 00:00:03.000: "), ("1 2", "the cue at 00:00:03.000: a map of another grid")):
        own.write_text(cue(1, 100) + cue(2, "What a blow!") + cue(3, text) + cue(4, 100), encoding="utf-8")
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", str(film), "-i", str(own), "-c:v", "copy", "-c:s", "srt", "-metadata:s:s:0", "title=Tactile",
                        "-metadata:s:s:0", "language=zxx", str(carrier)], check=True)
        mpv = Mpv(carrier, "--loop")
        follower = Follower(mpv)
        follower.wait_for(f"nothing is felt of 'carrier.mkv': its track is faulty: '{carrier}': {where}")
        assert f"fault:    '{carrier}': {where}" in ask("--status")
        ask("--pass-over")
        follower.wait_for("plays 'carrier.mkv' with a draft")
        follower.end()
        mpv.quit()
        extracted = track("extract", str(carrier), "-o", str(work / "extracted.vtt"))
        assert extracted.returncode == 1 and where in extracted.stderr, extracted
    # Subtitles are nobody's track, whatever they are.
    film.with_suffix(".vtt").write_text("WEBVTT\n\n00:02.000 --> 00:03.000\n1984: London\n\n00:01.000 --> 00:01.500\n100\n", encoding="utf-8")
    mpv = Mpv(film, "--loop")
    follower = Follower(mpv)
    follower.wait_for("plays 'faulty.mkv' with a draft")
    follower.end()
    mpv.quit()
    shutil.rmtree(film.parent)


def ask(*words, status=0):
    result = subprocess.run([FOLLOW, *words], capture_output=True, text=True, check=False, timeout=LATEST)
    assert result.returncode == status, result
    return result.stdout + result.stderr


def status():
    """By options, by D-Bus and by signals; remembered for each kind of player."""
    assert "no visuotactile-follow runs" in ask("--status", status=1)
    assert "no visuotactile-follow runs" in ask("--nudge=10", status=1)
    assert "--nudge is a number from -5000 to 5000, got 9000" in ask("--nudge=9000", status=2)
    film = make_film("status.mkv", 20, pattern=None)
    make_track(film.with_suffix(".csv"), 20)
    mpv = Mpv(film, "--loop")
    follower = Follower(mpv)
    follower.wait_for("plays 'status.mkv' with")
    vest.wait_to_feel()
    assert "state:    plays" in ask("--status")
    mpv.command("set_property", "pause", True)
    wait_until("the pause", lambda: "state:    paused" in ask("--status"))
    said = ask("--status")
    assert 1 <= float(said.split("position:")[1].split()[0]) < 20, said
    for line in ( f"player:   mpv at {mpv.path}", "film:     status.mkv", f"track:    '{film.with_suffix('.csv')}'", "latency:  +0 ms, of the screen", "offset:   +0 ms"):
        assert line in said, said
    bus = dbus.SessionBus(private=True)
    service = bus.get_object(NAME, PATH)
    assert ask("--nudge=40") == "offset: +40 ms\n"
    assert service.Nudge(-15.0, dbus_interface=NAME) == 25
    assert service.Get(NAME, "Offset", dbus_interface="org.freedesktop.DBus.Properties") == 25
    remembered = lambda: (work / "config/visuotactile/follow.conf").read_text(encoding="utf-8")
    assert "[mpv]" in remembered() and "offset=25" in remembered(), remembered()
    for number, offset in ((signal.SIGUSR1, 35), (signal.SIGUSR2, 25), (signal.SIGUSR2, 15)):
        follower.process.send_signal(number)
        wait_until(f"an offset of {offset}", lambda: f"offset={offset}\n" in remembered())
    # With one film, whatever plays it.
    assert ask("--nudge-film=-30") == "offset: -30 ms\n" and service.NudgeFilm(5.0, dbus_interface=NAME) == -25
    assert "[film status.mkv]\noffset=-25\n" in remembered() and "offset=15\n" in remembered(), remembered()
    assert (work / "config/visuotactile/follow.conf").stat().st_mode & 0o777 == 0o600
    # Another one follows, too, and says that it is not the one that is asked.
    other = Follower(mpv)
    other.wait_for("another visuotactile-follow has the name")
    other.end()
    follower.end()
    follower = Follower(mpv)
    follower.wait_for("plays 'status.mkv' with")
    assert "offset:   +15 ms, with this film -25 ms more" in ask("--status")
    follower.end()
    latencies_of_each_kind(mpv, bus)
    # What is no key file is not overwritten.
    (work / "config/visuotactile/follow.conf").write_text("nonsense\n", encoding="utf-8")
    follower = Follower(mpv)
    assert follower.process.wait(LATEST) == 1 and "cannot read" in follower.said(), follower.said()
    assert remembered() == "nonsense\n"
    (work / "config/visuotactile/follow.conf").unlink()
    mpv.quit()
    shutil.rmtree(film.parent)


def latencies_of_each_kind(mpv, bus):
    """An option goes before what is set for a kind of player. What is no time counts as not set."""
    settings = work / "config/visuotactile/follow.conf"
    settings.write_text("[mpv]\noffset=15\nscreen-latency=30\nsound-latency=120\n[vlc]\nscreen-latency=70\n", encoding="utf-8")
    for options, sync, latency in (([], "screen", 30), (["--sync-to=sound"], "sound", 120), (["--sound-latency=-80"], "screen", 30),
                                   (["--sync-to=sound", "--sound-latency=-80"], "sound", -80), (["--screen-latency=0"], "screen", 0)):
        follower = Follower(mpv, *options)
        follower.wait_for("plays 'status.mkv' with")
        said = bus.get_object(NAME, PATH).GetAll(NAME, dbus_interface="org.freedesktop.DBus.Properties")
        assert (said["SyncTo"], said["Latency"], said["Offset"]) == (sync, latency, 15), (options, said)
        follower.end()
    settings.write_text("[mpv]\nscreen-latency=soon\n", encoding="utf-8")
    follower = Follower(mpv)
    follower.wait_for("plays 'status.mkv' with")
    assert "latency:  +0 ms, of the screen" in ask("--status")
    # What is written there meanwhile is not lost, and counts with the next nudge.
    settings.write_text("[mpv]\nsync-to=sound\nsound-latency=55\n", encoding="utf-8")
    assert ask("--nudge=5") == "offset: +5 ms\n"
    assert "latency:  +55 ms, of the sound" in ask("--status")
    assert settings.read_text(encoding="utf-8").split() == ["[mpv]", "sync-to=sound", "sound-latency=55", "offset=5"]
    follower.end()


def wakes(tasks, seconds):
    """How often a second threads wake up."""
    def waits():
        count = 0
        for task in tasks():
            with contextlib.suppress(FileNotFoundError):  # it has ended
                count += sum(int(line.split()[1]) for line in open(task / "status", encoding="utf-8") if line.startswith("voluntary_"))
        return count

    begin, before = time.monotonic(), waits()
    wait_until(f"{seconds} s", lambda: time.monotonic() > begin + seconds)
    return (waits() - before) / (time.monotonic() - begin)


def wakings():
    """While a track plays, its main loop wakes up for mpv's reports of 25 frames a second and for the track, and not by itself in between."""
    film = make_film("wakings.mkv", 30)
    make_track(film.with_suffix(".csv"), 30)
    mpv = Mpv(film, "--loop")
    follower = Follower(mpv)
    vest.wait_to_feel()
    main = pathlib.Path(f"/proc/{follower.process.pid}/task/{follower.process.pid}")
    rate = wakes(lambda: [main], 6)
    print(f"{rate:.0f} wake-ups a second of the main loop, {wakes(lambda: main.parent.iterdir(), 6):.0f} of all threads")
    assert rate < 45, rate
    follower.end()
    mpv.quit()


def activation():
    """The bus starts a follower for whom calls it, by the file that is installed. systemd finds nothing wrong with the unit."""
    services = work / "data/dbus-1/services"
    services.mkdir(parents=True)
    installed = pathlib.Path(os.environ["SESSION"])
    text = (installed / f"{NAME}.service").read_text(encoding="utf-8")
    program = next(line.removeprefix("Exec=") for line in text.split("\n") if line.startswith("Exec="))
    wrapper = work / "visuotactile-follow"
    wrapper.write_text(f"#!/bin/sh\nexec {FOLLOW} --driver=simulator 2>{work}/log\n", encoding="utf-8")
    wrapper.chmod(0o755)
    (services / f"{NAME}.service").write_text(text.replace(program, str(wrapper)), encoding="utf-8")
    _, address = start_bus(dict(os.environ, XDG_DATA_HOME=str(work / "data")))
    bus = dbus.bus.BusConnection(address)
    assert not bus.name_has_owner(NAME)
    service = bus.get_object(NAME, PATH)
    assert service.Get(NAME, "State", dbus_interface="org.freedesktop.DBus.Properties") == "idle"
    pid = bus.get_object("org.freedesktop.DBus", "/org/freedesktop/DBus").GetConnectionUnixProcessID(NAME)
    # Without a player, it wakes up less than once a second, on a slow computer more seldom.
    tasks = pathlib.Path(f"/proc/{pid}/task")
    # GLib's threads of the start end after some seconds.
    assert wakes(tasks.iterdir, 10) < 1.2 or wakes(tasks.iterdir, 10) < 1.2
    os.kill(pid, signal.SIGTERM)
    wait_until("its end", lambda: not bus.name_has_owner(NAME))
    unit = (installed / "visuotactile-follow.service").read_text(encoding="utf-8")
    assert f"BusName={NAME}" in unit and f"ExecStart={program}" in unit, unit
    (work / "visuotactile-follow.service").write_text(unit.replace(program, str(wrapper)), encoding="utf-8")
    verified = subprocess.run(["systemd-analyze", "--user", "--man=no", "verify", str(work / "visuotactile-follow.service")], capture_output=True, text=True, check=False,
                              env=dict(os.environ, XDG_RUNTIME_DIR=str(work)))
    assert verified.returncode == 0 and "visuotactile" not in verified.stderr, verified


def ways_out():
    """What ends what is felt, and what brings it back."""
    logind_bus = dbus.bus.BusConnection(os.environ["DBUS_SYSTEM_BUS_ADDRESS"])
    start("/usr/bin/python3", "-m", "dbusmock", "--system", "--template", "logind", stdout=subprocess.DEVNULL)
    wait_until("logind", lambda: logind_bus.name_has_owner(LOGIND))
    logind = logind_bus.get_object(LOGIND, "/org/freedesktop/login1")
    mock = dbus.Interface(logind, dbusmock.MOCK_IFACE)
    mock.AddSession("auto", "seat0", dbus.UInt32(os.getuid()), "somebody", True)
    own = logind_bus.get_object(LOGIND, "/org/freedesktop/login1/session/auto")
    table = ["| event | until every motor is at zero |", "|---|---|"]
    inhibitors = lambda: logind.ListInhibitors(dbus_interface=f"{LOGIND}.Manager")

    film = make_film("ways-out.mkv", 100, pattern=None)
    make_track(film.with_suffix(".csv"), 100)
    mpv = Mpv(film)
    own.UpdateProperties(f"{LOGIND}.Session", {"LockedHint": True}, dbus_interface=dbusmock.MOCK_IFACE)
    follower = Follower(mpv)
    follower.wait_for("nothing is felt: the screen is locked")  # it was, before
    own.UpdateProperties(f"{LOGIND}.Session", {"LockedHint": False}, dbus_interface=dbusmock.MOCK_IFACE)
    wait_until("an inhibitor", lambda: len(inhibitors()) == 1)
    assert [str(part) for part in inhibitors()[0][:2]] == ["sleep", "visuotactile-follow"] and inhibitors()[0][3] == "delay", inhibitors()
    vest.wait_to_feel()

    def rests(why, say, what):
        """Something tells it while a motor is on."""
        vest.wait_to_feel()
        told = time.monotonic()
        say()
        follower.wait_for(f"nothing is felt: {why}")
        wait_until("silence", vest.is_silent)
        table.append(f"| {what} | {1000 * (next(at for at, on in vest.lines if at > told and not on) - told):.0f} ms |")
        begin, seconds = time.monotonic(), 1.5  # longer than from pulse to pulse, by the vest's own lines
        wait_until("a pulse that is not felt", lambda: time.monotonic() > begin + seconds)
        assert not any(on for at, on in vest.lines if at > begin), f"felt while {why}"
        assert "state:    rests" in ask("--status")

    def goes_on():
        follower.log.write_text("", encoding="utf-8")
        vest.wait_to_feel()

    def sleep():
        """The computer may when the motors are at zero."""
        logind.EmitSignal(f"{LOGIND}.Manager", "PrepareForSleep", "b", [True], dbus_interface=dbusmock.MOCK_IFACE)
        wait_until("that it may sleep", lambda: not inhibitors())
        # On a busy computer the vest's lines come later than its server's answer.
        wait_until("silence when it may sleep", vest.is_silent)

    def lock():
        own.EmitSignal(f"{LOGIND}.Session", "Lock", "", [], dbus_interface=dbusmock.MOCK_IFACE)

    rests("the computer goes to sleep", sleep, "the computer goes to sleep")
    logind.EmitSignal(f"{LOGIND}.Manager", "PrepareForSleep", "b", [False], dbus_interface=dbusmock.MOCK_IFACE)
    goes_on()
    wait_until("an inhibitor again", lambda: len(inhibitors()) == 1)

    # The screen is locked, and unlocked: by logind's signal and hint, or by the player that somebody starts.
    rests("the screen is locked", lock, "the screen is locked (logind)")
    own.UpdateProperties(f"{LOGIND}.Session", {"LockedHint": False}, dbus_interface=dbusmock.MOCK_IFACE)
    goes_on()
    rests("the screen is locked", lock, "the screen is locked again")
    # The next film of a list begins by itself.
    begin = time.monotonic()
    mpv.command("loadfile", str(film))
    wait_until("the film again", lambda: time.monotonic() > begin + 3)
    assert not any(on for at, on in vest.lines if at > begin), "felt while the screen is locked"
    begin = time.monotonic()
    while not any(on for at, on in vest.lines if at > begin):
        assert time.monotonic() < begin + LATEST, "started in vain"
        mpv.command("set_property", "pause", True)
        time.sleep(0.5)  # mpv tells no changes that are over
        mpv.command("set_property", "pause", False)
        time.sleep(1.5)
    follower.log.write_text("", encoding="utf-8")

    # A screen saver.
    session_bus = dbus.SessionBus(private=True)
    rests("the screen saver is on", lambda: session_bus.send_message(active_changed(True)), "the screen saver is on")
    session_bus.send_message(active_changed(False))
    goes_on()
    # One that dies.
    session_bus.request_name("org.freedesktop.ScreenSaver")
    rests("the screen saver is on", lambda: session_bus.send_message(active_changed(True)), "the screen saver is on again")
    session_bus.release_name("org.freedesktop.ScreenSaver")
    goes_on()

    def told(what, say):
        vest.wait_to_feel()
        begin = time.monotonic()
        say()
        wait_until("silence", lambda: any(at > begin and not on for at, on in vest.lines))
        table.append(f"| {what} | {1000 * (next(at for at, on in vest.lines if at > begin and not on) - begin):.0f} ms |")

    told("the player is killed", mpv.process.kill)
    follower.end()
    mpv = Mpv(film)
    follower = Follower(mpv)
    told("visuotactile-follow is ended (SIGTERM)", follower.process.terminate)
    assert follower.process.wait(LATEST) == 0
    mpv.quit()
    print(*table, sep="\n")
    # The session bus is gone. A follower of one mpv goes on, one of all players ends.
    mpv = Mpv(film)
    anybody = start(FOLLOW, "--driver=simulator", stderr=subprocess.PIPE, text=True, env=dict(os.environ, XDG_RUNTIME_DIR=str(work)))
    wait_until("a follower of all", lambda: session_bus.name_has_owner(NAME))
    alone = Follower(mpv)
    vest.wait_to_feel()
    session.kill()
    vest.wait_to_feel()
    alone.end()
    assert anybody.wait(LATEST) == 1 and "the session bus is gone" in anybody.stderr.read()
    mpv.quit()
    shutil.rmtree(film.parent)


def active_changed(active):
    message = dbus.lowlevel.SignalMessage("/org/freedesktop/ScreenSaver", "org.freedesktop.ScreenSaver", "ActiveChanged")
    message.append(dbus.Boolean(active))
    return message


run({"drafts": drafts, "embedded": embedded, "uneven": uneven, "library": library, "faulty": faulty, "status": status, "wakings": wakings, "activation": activation, "ways_out": ways_out})
