#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which elements keep a frame's tactile map? Runs frames with maps through them and prints a table.

Usage: survival.py [PAGE]      (with the plugins on GST_PLUGIN_PATH; fails unless PAGE has this table as its column of this GStreamer,
and is skipped if it has none)
"""
import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstTactile", "1.0")
from gi.repository import Gst, GstTactile  # noqa: E402

FRAMES = 12
SOURCE = f"tactiletestsrc num-buffers={FRAMES} ! video/x-raw,format=I420,width=64,height=48,framerate=30/1 ! saliencytactile rows=2 columns=3 ! "

HEAD = "frames with maps through"

# Name and launch line.
CHAINS = [
    ("queues and other plumbing", "queue ! identity ! tee ! multiqueue ! valve ! clocksync ! input-selector ! funnel ! concat"),
    ("`videoconvert` to RGB", "videoconvert ! video/x-raw,format=RGB"),
    ("`videoscale`", "videoscale ! video/x-raw,width=32,height=32"),
    ("`videoconvertscale`", "videoconvertscale ! video/x-raw,format=BGRx,width=32"),
    ("`videorate` to 15 Hz", "videorate ! video/x-raw,framerate=15/1"),
    ("`videorate` to 60 Hz", "videorate ! video/x-raw,framerate=60/1"),
    ("`videocrop`", "videocrop left=8"),
    ("`aspectratiocrop`", "aspectratiocrop aspect-ratio=1/1"),
    ("`videobox`", "videobox left=-8"),
    ("`videoflip`, turned", "videoflip method=clockwise"),
    ("`videobalance`", "videobalance saturation=0.5"),
    ("`gamma`", "gamma gamma=2"),
    ("`alpha`", "alpha alpha=0.5"),
    ("`textoverlay`", "textoverlay text=x"),
    ("`deinterlace`, on progressive video", "deinterlace"),
    ("`deinterlace`, on interlaced video", "interlace field-pattern=2:2 ! deinterlace"),
    ("`avdeinterlace`", "avdeinterlace"),
    ("`compositor`", "compositor"),
    ("`edgetv`", "videoconvert ! edgetv"),
    ("`imagefreeze`", f"imagefreeze num-buffers={FRAMES}"),
    ("`x264enc`, `avdec_h264`", "x264enc tune=zerolatency ! avdec_h264"),
    ("`jpegenc`, `jpegdec`", "jpegenc ! jpegdec"),
    ("`vp8enc`, `vp8dec`", "vp8enc deadline=1 ! vp8dec"),
    ("`matroskamux`, `matroskademux`, raw video", "matroskamux ! matroskademux"),
    ("`rtpvrawpay`, `rtpvrawdepay`", "rtpvrawpay ! rtpvrawdepay"),
    ("`rtpgstpay`, `rtpgstdepay`", "rtpgstpay ! rtpgstdepay"),
    ("`tactileoverlay`", "tactileoverlay"),
    ("`tactileextractor`, its `src`", "tactileextractor"),
    ("`visuotactilesink`, before its video sink", None),
]


def count(description):
    """The number of frames that came out, and how many of them have the map that went in."""
    line = SOURCE + (f"{description} ! fakesink name=end" if description else "visuotactilesink name=end driver=simulator sync=false rows=2 columns=3 video-sink=fakesink")
    pipeline = Gst.parse_launch(line)
    seen = [0, 0]

    def on_frame(_pad, info):
        meta = GstTactile.buffer_get_tactile_meta(info.get_buffer())
        seen[0] += 1
        seen[1] += meta is not None and (meta.rows, meta.columns) == (2, 3)
        return Gst.PadProbeReturn.OK

    end = pipeline.get_by_name("end")
    if description is None:
        end = end.get_property("video-sink")
    end.get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, on_frame)
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(Gst.CLOCK_TIME_NONE, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    if message.type == Gst.MessageType.ERROR:
        raise SystemExit(f"{line}: {message.parse_error()[0].message}")
    pipeline.set_state(Gst.State.NULL)
    return seen


def verdict(frames, maps):
    return "kept" if maps == frames else "dropped" if maps == 0 else f"on {maps} of {frames} frames"


def column(page, version):
    """The page's verdicts by name for this version; none if it has no such column."""
    with open(page, encoding="utf-8") as lines:
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line.startswith("|")]
    heads = [row for row in rows if row[0] == HEAD]
    if not heads or version not in heads[0]:
        return None
    at = heads[0].index(version)
    return {row[0]: row[at] for row in rows if len(row) == len(heads[0])}


def main():
    Gst.init(None)
    version = ".".join(str(part) for part in Gst.version()[:2])
    page = column(sys.argv[1], version) if len(sys.argv) > 1 else {}
    if page is None:
        print(f"{sys.argv[1]} has no column of GStreamer {version}")
        sys.exit(77)
    wrong = []
    print(f"| {HEAD} | {version} |\n|---|---|")
    for name, description in CHAINS:
        frames, maps = count(description)
        if frames == 0:
            raise SystemExit(f"{name}: no frame came out")
        print(f"| {name} | {verdict(frames, maps)} |")
        if page and page.get(name) != verdict(frames, maps):
            wrong.append(f"{name}: expected {page.get(name)}")
    if wrong:
        raise SystemExit(f"{sys.argv[1]} has another column of GStreamer {version}: " + ", ".join(wrong))


if __name__ == "__main__":
    main()
