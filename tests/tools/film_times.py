#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A film's time 0 in each container: the same pictures, wherever a container begins to count, have the same track from the first picture on, and that
begins where ffprobe and mpv show it. Also films whose frames' times do not advance.

Each film is one second of gray, then a ball that leaps to another place each half second. ffmpeg makes the containers, from one stream where they take
it, and ffprobe and mpv (by its socket) say at which time their 0:00 has the first picture.

GStreamer's players play a track beside the film and one that was muxed: its cues are on the frames that they were made for, beside it after a seek, too.

Prints a table. Usage: film_times.py [PART ...]      of containers, players, beside, muxed, foreign, animations
Expects TRACK, the plugins on GST_PLUGIN_PATH, ffmpeg and mpv. Files of ../shared/data/files are looked at where they are there."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402
from mpv_socket import MpvSocket  # noqa: E402

os.environ["GST_PLUGIN_FEATURE_RANK"] = "tactilesubtitles:MAX"
Gst.init(None)
TRACK = os.environ["TRACK"]
FILES = pathlib.Path(__file__).resolve().parents[2].parent / "shared/data/files"
LATEST = 60  # s: until something that has to happen has failed to
RATE = 25
FRAME = 1 / RATE
# What players and GStreamer may differ by: Matroska's and FLV's ms, the ticks of MPEG's 90 kHz, and what is rounded down to 1 ms in a text cue.
SAME = 0.0025

work = pathlib.Path(tempfile.mkdtemp(prefix="visuotactile-film-times-"))


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=LATEST, check=False, **options)
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def ffmpeg(name, *words):
    run("ffmpeg", "-v", "error", "-y", *words, work / name)


def make_films():
    """Name of a film, and whether mpv takes its 0:00 from the container rather than the earliest picture or sound: MP4 has a time line of its own."""
    ball = ("color=c=gray:s=320x240:r=25:d=3,geq=lum='if(lt(T\\,1)\\,126\\,if(lt(hypot(X-60-200*mod(floor(2*T)\\,2)\\,Y-60-120*mod(floor(T)\\,2))"
            "\\,30)\\,235\\,126))':cb=128:cr=128")
    sound = ("-f", "lavfi", "-i", "sine=f=440:d=3")
    h264 = ("-c:v", "libx264", "-preset", "ultrafast", "-qp", "8", "-bf", "2", "-g", "25")
    mpeg2 = ("-c:v", "mpeg2video", "-q:v", "2", "-bf", "2", "-g", "15", "-c:a", "mp2")
    ffmpeg("silent.mp4", "-f", "lavfi", "-i", ball, *h264)
    ffmpeg("sound.mp4", "-i", work / "silent.mp4", *sound, "-c:v", "copy", "-c:a", "aac")
    one, both = ("-i", work / "silent.mp4", "-c", "copy"), ("-i", work / "sound.mp4", "-c", "copy")
    late = ("-itsoffset", "1.5", "-i", work / "silent.mp4", "-i", work / "sound.mp4", "-map", "0:v", "-map", "1:a", "-c", "copy")
    ffmpeg("first_edit_empty.mp4", "-itsoffset", "2", *one, "-avoid_negative_ts", "disabled")
    ffmpeg("late_picture.mp4", *late)
    ffmpeg("fragments.mp4", *both, "-movflags", "frag_keyframe+empty_moov")
    ffmpeg("silent.ts", *one)
    ffmpeg("sound.ts", *both)
    ffmpeg("10h.ts", *both, "-output_ts_offset", "36000")
    ffmpeg("wraps.ts", *both, "-output_ts_offset", str(2**33 / 90000 - 3))
    ffmpeg("late_sound.ts", "-i", work / "silent.mp4", "-itsoffset", "0.8", "-i", work / "sound.mp4", "-map", "0:v", "-map", "1:a", "-c", "copy")
    ffmpeg("sound.mpg", "-i", work / "sound.mp4", *mpeg2)
    ffmpeg("10h.vob", "-i", work / "sound.mp4", *mpeg2, "-f", "vob", "-output_ts_offset", "36000")
    ffmpeg("silent.mkv", *one)
    ffmpeg("10h.mkv", *one, "-output_ts_offset", "36000")
    ffmpeg("late_picture.mkv", *late)
    ffmpeg("100s.flv", *both, "-output_ts_offset", "100")
    ffmpeg("sound.avi", "-i", work / "sound.mp4", "-c:v", "mpeg4", "-q:v", "2", "-c:a", "mp3")


def packets_start(film):
    """When the first picture is shown by the container's time line, and that line's 0:00 by ffprobe."""
    told = json.loads(run("ffprobe", "-v", "error", "-show_entries", "format=start_time", "-select_streams", "v", "-show_entries",
                          "frame=best_effort_timestamp_time", "-read_intervals", "%+#8", "-of", "json", film))
    first = min(float(frame["best_effort_timestamp_time"]) for frame in told["frames"])
    start = float(told["format"]["start_time"])
    # As mpv, which does not take the start of an MP4 away, nor one before 0 in Matroska, as that of Opus.
    is_taken = film.suffix not in (".mp4", ".mov") and not (film.suffix in (".mkv", ".webm") and start < 0)
    return first - (start if is_taken else 0)


class Mpv(MpvSocket):
    """Stands at the first picture."""

    def __init__(self, film, *options):
        super().__init__(str(work / "mpv.sock"))
        pathlib.Path(self.path).unlink(missing_ok=True)
        self.process = subprocess.Popen(["mpv", "--no-config", "--vo=null", "--ao=null", "--pause", *options, f"--input-ipc-server={self.path}", str(film)],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_until("mpv's socket", self.connects)
        self.told, self.asked = self.line.makefile("r", encoding="utf-8"), 0

    @staticmethod
    def wait_until(what, is_true):
        end = time.monotonic() + LATEST
        while not is_true():
            assert time.monotonic() < end, f"waited {LATEST} s in vain for {what}"
            time.sleep(0.01)

    def get(self, name):
        self.asked += 1
        self.line.sendall((json.dumps({"command": ["get_property", name], "request_id": self.asked}) + "\n").encode())
        while (answer := json.loads(self.told.readline())).get("request_id") != self.asked:
            pass
        return answer.get("data")

    def first_picture(self):
        """The next but one, less two frames: before playback goes on, mpv's position is where it was told to begin."""
        self.wait_until("a picture", lambda: self.get("estimated-vf-fps") or self.get("vo-configured"))
        for _ in range(2):
            before = self.get("time-pos")
            self.command("frame-step")
            self.wait_until("the next picture", lambda: self.get("time-pos") != before and self.get("pause"))
        return self.get("time-pos")

    def seek(self, to):
        self.command("seek", to - FRAME / 4, "absolute+exact")
        self.wait_until(f"the picture at {to:.3f} s", lambda: abs((self.get("time-pos") or 0) - to) < SAME)

    def quit(self):
        self.process.kill()
        self.process.wait()


def felt(film, *options):
    """When something is felt for the first time, and all that is felt, from its first time on."""
    path = work / "track.csv"
    run(TRACK, "author", "-f", "-q", "--rate=0", *options, film, "-o", path)
    rows = [[float(word) for word in line.split(",")] for line in path.read_text(encoding="utf-8").splitlines()[2:]]
    begin = next(row[0] for row in rows if any(row[1:]))
    return begin / 1000


def containers():
    # The times in the film itself: MP4, whose first picture is at 0 in all players.
    after = felt(work / "silent.mp4") - packets_start(work / "silent.mp4")
    assert 1 - SAME < after < 1 + 4 * FRAME, f"felt {after} s after the first picture; the ball is there after 1 s"
    print("| film | first picture by ffprobe | felt from then on, after | wrong by |\n|---|---|---|---|")
    wrong = []
    for film in sorted(path for path in work.iterdir() if path.suffix in (".mp4", ".ts", ".mpg", ".vob", ".mkv", ".flv", ".avi")):
        first = packets_start(film)
        begin = felt(film)
        # MPEG-2 and MPEG-4 are other pictures, in which the ball may be felt a frame sooner or later.
        allowed = SAME + (FRAME if film.suffix in (".mpg", ".vob", ".avi") else 0)
        off = begin - first - after
        print(f"| {film.name} | {first:.3f} s | {begin - first:.3f} s | {1000 * off:+.1f} ms |", flush=True)
        wrong += [film.name] if abs(off) > allowed else []
    assert not wrong, wrong


def players():
    """mpv's own word for the first pictures."""
    for name in ("silent.mp4", "first_edit_empty.mp4", "late_picture.mp4", "sound.ts", "10h.ts", "sound.mpg", "10h.mkv", "100s.flv"):
        film = work / name
        mpv = Mpv(film)
        at = mpv.first_picture() - 2 * FRAME
        mpv.quit()
        assert abs(at - packets_start(film)) < SAME, f"{name}: mpv shows the first picture at {at:.3f} s, expected {packets_start(film):.3f} s"


class Playbin:
    """Plays a film and a track beside it or in it, as fast as it can, and keeps what each frame has."""

    def __init__(self, kind, film, track=None):
        self.maps = {}  # frame's stream time in ns → whether it is felt
        self.has_cue, self.has_text = threading.Event(), threading.Event()
        self.play = Gst.ElementFactory.make(kind)
        self.play.connect("deep-element-added", self._listen)
        self.play.get_by_name("playsink").connect("pad-added", self._hold)
        sink = Gst.parse_bin_from_description(
            "tactileextractor name=x x.src ! queue ! fakesink x.tactile ! queue ! appsink name=maps sync=false emit-signals=true", True)
        sink.get_by_name("maps").connect("new-sample", self._keep)
        for name, value in (("uri", film.as_uri()), ("suburi", track and track.as_uri()), ("video-sink", sink), ("audio-sink", Gst.ElementFactory.make("fakesink"))):
            self.play.set_property(name, value)
        self.bus = self.play.get_bus()
        self.is_beside = track is not None
        self.frames = 0
        if self.is_beside:
            self.pause()

    def _listen(self, _top, _bin, element):
        if element.get_factory() and element.get_factory().get_name() == "tactilesubtitles":
            element.get_static_pad("text_sink").add_probe(Gst.PadProbeType.BUFFER | Gst.PadProbeType.EVENT_DOWNSTREAM, self._heard)

    def _hold(self, _playsink, pad):
        """playbin3 may show the film's first frame before it has looked at the track, and takes no more streams in while that frame stands."""
        if pad.get_name().startswith("text"):
            self.has_text.set()
        elif pad.get_name().startswith("video"):
            pad.add_probe(Gst.PadProbeType.BUFFER, self._wait)

    def _wait(self, _pad, _info):
        """Nor does a film that is played so fast wait for the track in it."""
        self.has_text.wait(LATEST)
        self.frames += 1
        if self.frames == 45 and not self.is_beside:
            self.has_cue.wait(LATEST)
        return Gst.PadProbeReturn.OK

    def _heard(self, _pad, info):
        if info.type & Gst.PadProbeType.BUFFER:
            time_ = info.get_buffer().pts
        elif info.get_event().type == Gst.EventType.GAP and info.get_event().get_structure().has_field("tactile-packet"):
            time_, _ = info.get_event().parse_gap()
        else:
            return Gst.PadProbeReturn.OK
        if self.is_beside or time_ > 1.5 * Gst.SECOND:
            self.has_cue.set()
        return Gst.PadProbeReturn.OK

    def pause(self):
        """Until the first frame and the track's cue are there: a film does not wait for its track."""
        self.state(Gst.State.PAUSED)
        assert self.has_cue.wait(LATEST), "no cue has come"

    def _keep(self, sink):
        sample = sink.emit("pull-sample")
        buffer = sample.get_buffer()
        time_ = sample.get_segment().to_stream_time(Gst.Format.TIME, buffer.pts)
        self.maps[time_] = any(buffer.extract_dup(0, buffer.get_size()))
        return Gst.FlowReturn.OK

    def state(self, state):
        self.play.set_state(state)
        assert self.play.get_state(LATEST * Gst.SECOND)[0] == Gst.StateChangeReturn.SUCCESS

    def play_to_end(self):
        self.state(Gst.State.PLAYING)
        message = self.bus.timed_pop_filtered(LATEST * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        assert message is not None and message.type == Gst.MessageType.EOS, message and message.parse_error()

    def seek(self, to):
        self.state(Gst.State.PAUSED)
        self.maps.clear()
        self.has_cue.clear()
        assert self.play.seek_simple(Gst.Format.TIME, Gst.SeekFlags.FLUSH | Gst.SeekFlags.ACCURATE, round(to * Gst.SECOND))
        self.pause()

    def quit(self):
        self.play.set_state(Gst.State.NULL)


def played(kind, film):
    """A film played to its end. On a busy PC playbin3 of GStreamer 1.22 shows no first frame of about one film in ten, without this project's plugins and
    with fakesinks, too: then it begins again."""
    for patience in (10, 10, 10, 10, LATEST):
        play = Playbin(kind, film)
        play.play.set_state(Gst.State.PLAYING)
        if play.play.get_state(patience * Gst.SECOND)[0] == Gst.StateChangeReturn.SUCCESS or kind == "playbin" or Gst.version()[1] > 22:
            break
        play.quit()
    play.play_to_end()
    play.quit()
    return play


def felt_frames(play):
    """The first frame that is felt, and the first after it that is not. A map may begin a little before its frame."""
    times = sorted(play.maps)
    on = [time_ for time_ in times if play.maps[time_]]
    assert on and all(play.maps[time_] for time_ in times if on[0] <= time_ <= on[-1]), f"felt at {on}"
    end = next(time_ for time_ in times if time_ > on[-1])
    # Frames follow one another; a silence before the first one is none.
    first = next(time_ for time_ in times if any(abs(later - time_ - FRAME * Gst.SECOND) < 2 * Gst.MSECOND for later in times))
    return tuple(round((time_ - first) / Gst.SECOND / FRAME) for time_ in (on[0], end))


def make_track(path, film):
    """A cue for the frames from the 50th to the 59th, silence for the others."""
    begin, end = (f"00:00:0{packets_start(film) + number * FRAME - 0.001:.3f}" for number in (50, 60))
    path.write_text(f"WEBVTT\n\nNOTE tactile grid=1x1 rate=5\n\n{begin} --> {end}\n100\n", encoding="utf-8")


def muxed():
    """A film that mux has written, from and to each kind of container. mpv shows the cue as what it is for it, subtitles, but for KLV, which it passes over.
    playbin3 of GStreamer 1.22 does not select KLV."""
    track = work / "muxed.vtt"
    ffmpeg("sound.webm", "-i", work / "sound.mp4", "-c:v", "libvpx", "-deadline", "realtime", "-cpu-used", "8", "-b:v", "1M", "-c:a", "libopus")
    ffmpeg("sound.mov", "-i", work / "sound.mp4", "-c", "copy")
    for source, ending in (("sound.mp4", "mkv"), ("sound.webm", "mkv"), ("late_picture.mkv", "mkv"), ("sound.mov", "mp4"), ("10h.mkv", "mp4"), ("sound.mp4", "ts"), ("sound.ts", "ts")):
        film = work / f"muxed.{ending}"
        make_track(track, work / source)
        done = subprocess.run([TRACK, "mux", "-f", work / source, track, "-o", film], capture_output=True, text=True, timeout=3 * LATEST, check=False)
        assert done.returncode in (0, 3), done  # 3: names that the container cannot hold
        for kind in ("playbin", "playbin3") if ending != "ts" else ("playbin",):
            on = felt_frames(played(kind, film))
            assert on == (50, 60), f"{source} in {ending}, {kind}: felt at the frames {on}"
        mpv = Mpv(film, "--sid=1")
        at = mpv.first_picture() - 2 * FRAME
        if ending == "ts":
            told = json.loads(run("ffprobe", "-v", "error", "-show_entries", "format=start_time:packet=pts_time", "-select_streams", "d", "-of", "json", film))
            times = [float(packet["pts_time"]) - float(told["format"]["start_time"]) for packet in told["packets"]]
            # The last packet is the cue, which says its end itself.
            assert abs(times[-1] - at - 50 * FRAME) < 2 * SAME, (source, at, times)
        else:
            for number, is_shown in ((50, True), (49, False), (59, True), (60, False)):
                mpv.seek(at + number * FRAME)
                Mpv.wait_until(f"{'a' if is_shown else 'no'} cue at frame {number} of {source} in {ending}", lambda: (mpv.get("sub-text") == "100") == is_shown)
        mpv.quit()


def beside():
    """GStreamer begins to play before it knows of sound that is earlier than the picture, here 11 or 23 ms:
    then they may be one frame late."""
    for name in ("silent.mp4", "silent.ts", "sound.ts", "sound.mpg", "10h.mkv"):
        film, track = work / name, work / "beside.vtt"
        make_track(track, film)
        for kind in ("playbin", "playbin3"):
            play = Playbin(kind, film, track)
            play.play_to_end()
            on = felt_frames(play)
            late = 1 if name.startswith("sound") and on[0] == 51 else 0
            assert on == (50 + late, 60 + late), f"{name}, {kind}: felt at the frames {on}"
            lit = sorted(time_ for time_, is_on in play.maps.items() if is_on)
            play.seek(1.4)
            play.play_to_end()
            play.quit()
            again = sorted(time_ for time_, is_on in play.maps.items() if is_on)
            assert again == lit, f"{name}, {kind}: after a seek felt at {again}, expected {lit}"


def foreign():
    """By issue 43: the frame that players show at 1.02 s was felt at 1.767 s."""
    if FILES.exists():
        begin, base = felt(FILES / "hours.ts"), felt(FILES / "base.mkv")
        shift = packets_start(FILES / "hours.ts") - packets_start(FILES / "base.mkv")
        assert abs(begin - base - shift) < 2 / 30, (begin, base, shift)


def animations():
    """GStreamer 1.22 gives each frame of a GIF the time 0, and comes to no end of short ones."""
    ffmpeg("ball.gif", "-stream_loop", "1", "-i", work / "silent.mp4", "-vf", "fps=10")
    ffmpeg("slow.mp4", "-stream_loop", "1", "-i", work / "silent.mp4", "-vf", "fps=10", "-c:v", "libx264", "-qp", "8")
    begin, expected = felt(work / "ball.gif"), felt(work / "slow.mp4")
    assert abs(begin - expected) <= 0.1 + SAME, f"felt at {begin} s, expected {expected} s"
    if (FILES / "anim.gif").exists():
        felt(FILES / "anim.gif")
    ffmpeg("short.gif", "-i", work / "silent.mp4", "-vf", "fps=10")
    done = subprocess.run([TRACK, "author", work / "short.gif", "-o", work / "short.vtt"], capture_output=True, text=True, timeout=2 * LATEST, check=False)
    assert done.returncode == 0 or (done.returncode == 1 and "nothing comes after 30 frames" in done.stderr and not (work / "short.vtt").exists()), done


# "beside" is by hand: in playbin its cue does not come now and then.
try:
    make_films()
    for part in [globals()[name] for name in sys.argv[1:]] or [containers, players, muxed, foreign, animations]:
        begin = time.monotonic()
        part()
        print(f"{part.__name__}: {time.monotonic() - begin:.1f} s", flush=True)
finally:
    shutil.rmtree(work)
sys.exit(0)
