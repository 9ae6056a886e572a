#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""tactile-track hls --live beside a playlist that this test lets grow, slide, break and end: the rendition follows each step.
Environment: TRACK"""

import atexit
import os
import pathlib
import signal
import subprocess
import tempfile
import time

work = pathlib.Path(tempfile.mkdtemp())
video, master, index, ahap = work / "video.m3u8", work / "master.m3u8", work / "tactile/index.m3u8", work / "tactile.ahap"
HEAD = "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:1\n"


def show(first, end, is_over=False):
    """Writes the playlist of the segments from `first` to before `end`, as an encoder does."""
    text = HEAD + f"#EXT-X-MEDIA-SEQUENCE:{first}\n" + "".join(f"#EXTINF:1.0,\nvideo{n}.ts\n" for n in range(first, end))
    part = work / "part"
    part.write_text(text + ("#EXT-X-ENDLIST\n" if is_over else ""), encoding="utf-8")
    part.rename(video)


def expect(first, end, live):
    """Waits until the rendition has these segments. The test's own timeout ends a wait in vain."""
    expected = [f"{n}.vtt" for n in range(first, end)]
    while True:  # the multivariant playlist is the last that is written
        lines = index.read_text(encoding="utf-8").splitlines() if index.exists() else []
        is_there = [line for line in lines if line and not line.startswith("#")] == expected
        if is_there and 'NAME="Tactile"' in master.read_text(encoding="utf-8"):
            return lines
        assert live.poll() is None, (live.returncode, live.stderr.read(), lines)
        time.sleep(0.05)


def start():
    live = subprocess.Popen([os.environ["TRACK"], "hls", "--live", master, track], stderr=subprocess.PIPE, text=True)
    atexit.register(live.kill)
    return live


track = work / "track.csv"
track.write_text("# tactile grid=1x1 rate=0\ntime_ms,t0\n0,0\n" + "".join(f"{1000 * n + 100},0.{n}\n{1000 * n + 900},0\n" for n in range(1, 9)),
                 encoding="utf-8")
subprocess.run(["ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc=size=64x64:rate=25:duration=1", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-b:v", "100k",
                "-f", "hls", "-hls_list_size", "0", "-master_pl_name", "master.m3u8", video], check=True)

# The encoder has written nothing yet, then half of its first playlist.
video.rename(work / "aside")
live = start()
video.write_text("", encoding="utf-8")
video.write_text(HEAD + "#EXT-X-MEDIA-SEQ", encoding="utf-8")
show(0, 2)
expect(0, 2, live)
assert (work / "tactile/1.vtt").read_text(encoding="utf-8").count("00:00:01.100 --> 00:00:01.900") == 1
written = index.stat().st_ino
video.write_text("#EXTM3U\n#EXTINF:", encoding="utf-8")
show(0, 4)
expect(0, 4, live)
assert index.stat().st_ino != written
# It slides. Segments stay while players may still load them, and the film's times go on.
show(3, 6)
expect(3, 6, live)
assert (work / "tactile/0.vtt").exists()
assert (work / "tactile/5.vtt").read_text(encoding="utf-8").count("00:00:05.100 --> 00:00:05.900") == 1
show(5, 8)
expect(5, 8, live)
show(7, 9)
expect(7, 9, live)
assert not ahap.exists()  # a viewer who joins is not at 0:00
# A helper that is stopped leaves a playlist that players read, and the next one goes on.
live.send_signal(signal.SIGTERM)
assert live.wait() == 130, (live.returncode, live.stderr.read())
live = start()
show(7, 9, is_over=True)
assert live.wait() == 0, live.stderr.read()
assert expect(7, 9, live)[-1] == "#EXT-X-ENDLIST"
assert ahap.exists()
assert not (work / "tactile/0.vtt").exists() and (work / "tactile/8.vtt").exists()
