#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A film over HLS with the chair: tactile-track hls writes the track beside what ffmpeg made, a static server serves it, and
gst-play-1.0 plays it, by playbin3's hlsdemux2, on demand and live. Environment: TRACK, the plugins on GST_PLUGIN_PATH_1_0"""

import csv
import functools
import http.server
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import threading

SECONDS, SEGMENT, FRAME = 7, 1.0, 0.04
SHORT = 4
# Cue k is felt for 0.3 s from 0.5 k + 0.1 s on, with a level that says which it is.
CUES = {round(0.41 + 0.03 * k, 2): 0.5 * k + 0.1 for k in range(2 * SECONDS)}
LENGTH = 0.3

work = pathlib.Path(tempfile.mkdtemp())


def run(*command, status=0):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, cwd=work)
    assert done.returncode == status, (command, done.stdout[-2000:], done.stderr[-2000:])
    return done.stdout if status == 0 else done.stderr


GSTREAMER = tuple(map(int, re.search(r"GStreamer (\d+)\.(\d+)", run("gst-play-1.0", "--version")).groups()))


def make_film(name, kind, seconds):
    folder = work / name
    folder.mkdir()
    run("ffmpeg", "-v", "error", "-f", "lavfi", "-i", f"testsrc=size=320x240:rate=25:duration={seconds}", "-c:v", "libx264", "-preset",
        "ultrafast", "-pix_fmt", "yuv420p", "-b:v", "200k", "-g", "25", "-f", "hls", "-hls_segment_type", kind, "-hls_time", SEGMENT,
        "-hls_list_size", "0", "-master_pl_name", "master.m3u8", folder / "video.m3u8")
    return folder


def play(folder, handler=http.server.SimpleHTTPRequestHandler, ended=None):
    """The film times at which each level was felt first, by the chair's trace, and what was asked of the server. `ended`: set when a live
    film has no more segments."""
    asked = []

    class Logged(handler):
        def do_GET(self):
            asked.append(self.path)
            super().do_GET()

        def log_message(self, *_):
            pass

    trace = folder / "trace.csv"
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Logged, directory=folder)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with subprocess.Popen(
                ["gst-play-1.0", "--use-playbin3", "--no-interactive", "--audiosink=fakesink",
                 f"--videosink=visuotactilesink driver=simulator rate=0 trace-location={trace} video-sink=fakevideosink",
                 f"http://127.0.0.1:{server.server_port}/master.m3u8"],
                env=os.environ | {"GST_PLUGIN_FEATURE_RANK": "tactilesubtitles:MAX"}, stdout=subprocess.DEVNULL) as player:
            try:
                assert ended is None or ended.wait(120)
                # hlsdemux2 of GStreamer 1.26 never ends a film that was live, not even one without a track and a chair.
                is_endless = ended is not None and GSTREAMER >= (1, 26)
                try:
                    assert player.wait(4 * SECONDS if is_endless else 120) == 0
                except subprocess.TimeoutExpired:
                    assert is_endless
                    player.send_signal(signal.SIGINT)
                    assert player.wait(20) == -signal.SIGINT
            finally:
                player.kill()
        server.shutdown()
    felt = {}
    with open(trace, encoding="utf-8") as file:
        for command in csv.DictReader(file):
            felt.setdefault(round(float(command["volts"]) / 3, 2), int(command["effect_ns"]) / 1e9)
    # Without the soft start, in which the first cue is felt.
    cues = sorted((time, value) for value, time in felt.items() if value in CUES)
    return {value: time for time, value in cues[1:]}, asked


def expect_felt(levels, offset, cues):
    """A loaded machine drops frames, so that a cue is felt later within its length, or not; a wrong time would shift all."""
    assert 2 * len(levels) >= cues, (cues, levels)
    late = [time + offset - CUES[value] for value, time in levels.items()]
    assert all(-0.001 <= each < LENGTH for each in late) and min(late) <= FRAME, (offset, levels)


track = work / "track.csv"
lines = ["# tactile grid=1x1 rate=0", "time_ms,t0"]
for value, begin in CUES.items():
    lines += [f"{begin * 1000:.0f},{value}", f"{(begin + LENGTH) * 1000:.0f},0"]
track.write_text("\n".join([*lines[:2], "0,0", *lines[2:]]) + "\n", encoding="utf-8")

# On demand, in transport streams and fragmented MP4. A second call replaces what the first wrote.
for segments in "mpegts", "fmp4":
    film = make_film(segments, segments, SHORT)
    for _ in range(2):
        run(os.environ["TRACK"], "hls", film / "master.m3u8", track, "--url=https://example.org/film")
    master = (film / "master.m3u8").read_text(encoding="utf-8")
    assert master.count("TYPE=SUBTITLES") == 1 and master.count(',SUBTITLES="tactile"') == 1, master
    assert master.count('DATA-ID="com.apple.hls.haptics.url",VALUE="https://example.org/film/tactile.ahap"') == 1, master
    read = run("ffprobe", "-v", "error", "-show_entries", "packet=pts_time,duration_time", "-of", "csv=p=0", film / "tactile" / "2.vtt")
    found = [tuple(map(float, line.split(","))) for line in read.split() if line]
    felt_then = [(begin, LENGTH) for begin in CUES.values() if 2 <= begin < 3]
    assert all(any(abs(a - c) < 0.0015 and abs(b - d) < 0.0015 for c, d in found) for a, b in felt_then), (found, felt_then)
    again = run(os.environ["TRACK"], "diff", film / "tactile.ahap", track)
    assert again == "", again
    levels, requests = play(film)
    late = [time - CUES[value] for value, time in levels.items()]
    print(f"{segments}: {len(levels)} cues, {min(late):.3f} to {max(late):.3f} s late, {len(requests)} requests")
    expect_felt(levels, 0, sum(begin < SHORT for begin in CUES.values()) - 1)
    assert f"/tactile/{SHORT - 1}.vtt" in requests, requests

# Live: each time that the player asks for the playlist, the film is a segment longer, and the track with it.
film = make_film("live", "mpegts", SECONDS)
(film / "tactile.ahap").write_text("{}", encoding="utf-8")
assert "--force" in run(os.environ["TRACK"], "hls", film / "master.m3u8", track, status=1)
(film / "tactile.ahap").unlink()
whole = (film / "video.m3u8").read_text(encoding="utf-8")
parts = re.findall(r"#EXTINF:.*\n.*\n", whole)
shown = 3
lock = threading.Lock()
ended = threading.Event()


def show(count):
    first = max(count - 5, 0)
    text = f"#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:1\n#EXT-X-MEDIA-SEQUENCE:{first}\n" + "".join(parts[first:count])
    (film / "video.m3u8").write_text(text + ("#EXT-X-ENDLIST\n" if count == len(parts) else ""), encoding="utf-8")
    run(os.environ["TRACK"], "hls", film / "master.m3u8", track)


class Live(http.server.SimpleHTTPRequestHandler):
    def do_GET(self):
        global shown
        if self.path == "/video.m3u8":
            with lock:
                shown = min(shown + 1, len(parts))
                show(shown)
                if shown == len(parts):
                    ended.set()
        super().do_GET()


show(shown)
assert "haptics" not in (film / "master.m3u8").read_text(encoding="utf-8")
levels, requests = play(film, Live, ended)
print(f"live: {len(levels)} of {len(CUES)} cues, {len(requests)} requests")
assert requests.count("/tactile/index.m3u8") > 1, requests
# hlsdemux2 leaves the last segment out if it comes with the end of the stream.
assert f"/tactile/{len(parts) - 2}.vtt" in requests, requests
# A live film begins with one of its segments.
offset = round(sum(CUES[value] - time for value, time in levels.items()) / len(levels) / SEGMENT) * SEGMENT
# The player joins three segments before the end of what is there, and may miss the last one.
expect_felt(levels, offset, sum(SEGMENT <= begin < (len(parts) - 1) * SEGMENT for begin in CUES.values()))

# The picture begins 1.5 s after the sound: 0:00 is that of the sound.
film = work / "late"
film.mkdir()
run("ffmpeg", "-v", "error", "-f", "lavfi", "-i", "sine=duration=4", "-itsoffset", "1.5", "-f", "lavfi", "-i", "testsrc=size=320x240:rate=25:duration=2",
    "-c:v", "libx264", "-preset", "ultrafast", "-pix_fmt", "yuv420p", "-fps_mode", "passthrough", "-c:a", "aac", "-f", "hls", "-hls_list_size", "0",
    "-master_pl_name", "master.m3u8", film / "video.m3u8")
run(os.environ["TRACK"], "hls", film / "master.m3u8", track)
first = {kind: min(float(line) for line in run("ffprobe", "-v", "error", "-select_streams", kind, "-show_entries", "packet=pts_time", "-of",
                                               "csv=p=0", film / "video0.ts").replace(",", "").split()) for kind in "av"}
assert first["v"] - first["a"] > 1.4, first
map_line = (film / "tactile" / "0.vtt").read_text(encoding="utf-8").split("\n")[1]
assert abs(int(re.search(r"MPEGTS:(\d+)", map_line)[1]) / 90000 - first["a"]) < 0.001, (map_line, first)

# Playlists that are wrong.
media = run(os.environ["TRACK"], "hls", film / "video.m3u8", track, status=1)
assert "expected a multivariant playlist" in media, media
(film / "video.m3u8").write_text("#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\na.ts\n#EXT-X-DISCONTINUITY\n#EXTINF:1,\nb.ts\n", encoding="utf-8")
broken = run(os.environ["TRACK"], "hls", film / "master.m3u8", track, status=1)
assert "#EXT-X-DISCONTINUITY" in broken, broken
