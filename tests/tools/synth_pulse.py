#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether tactoraudiosink vibrates when a sound of the same time is heard.

One pipeline plays to PulseAudio's null sink, as a film's sound and its tactors do: tactilesynth on the left channel, from maps that switch
between silence and a level, and on the right channel a tone with the envelope that they should have. The null sink's monitor has both. Prints
the differences of their half-way times as a Markdown table: in one sink, where they are what tactilesynth adds, and in a sink each, with those
of plain sounds for comparison. Starts a PulseAudio server of its own.

Usage: synth_pulse.py [--runs=10] [--steps=5]      (starts of each, vibrations in each)
    with GST_PLUGIN_PATH_1_0 as set by `meson devenv -C build`
"""
import argparse
import os
import subprocess
import sys
import tempfile

import gi
import numpy

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

RATE = 48000
FRAME = 0.04  # s
HALF = 12  # frames of silence, and of vibration
TONE = 1000  # Hz: ten periods in the window of an envelope
WINDOW = RATE // 100  # samples
RAMP = 0.012  # s
ROOM = "max-size-bytes=0 max-size-buffers=0 max-size-time=1000000000"


def switches(steps):
    """Times in seconds at which the vibration begins or ends."""
    return [(HALF * (i + 1)) * FRAME for i in range(2 * steps)]


def push(source, data, pts, duration):
    buffer = Gst.Buffer.new_wrapped(data.tobytes())
    buffer.pts, buffer.duration = round(pts * Gst.SECOND), round(duration * Gst.SECOND)
    source.emit("push-buffer", buffer)


def fill(player, steps):
    maps, sounds = player.get_by_name("maps"), [player.get_by_name(name) for name in ("left", "right")]
    times = switches(steps)
    seconds = times[-1] + HALF * FRAME
    for i in range(round(seconds / FRAME)):
        if maps:
            push(maps, numpy.array([i // HALF % 2], "<f4"), i * FRAME, FRAME)
    at = numpy.arange(round(seconds * RATE)) / RATE
    amplitude = numpy.zeros_like(at)
    for i, t in enumerate(times):
        x = numpy.clip((at - t) / RAMP + 0.5, 0, 1)
        amplitude += (x - numpy.sin(2 * numpy.pi * x) / (2 * numpy.pi)) * (1 - i % 2 * 2)
    tone = amplitude * numpy.sin(2 * numpy.pi * TONE * at)
    for channel, source in enumerate(sounds):
        samples = numpy.stack([tone * (channel == 0), tone * (channel == 1)], 1).astype("<f4")
        for i in range(0, len(samples) if source else 0, RATE // 10):
            push(source, samples[i:i + RATE // 10], i / RATE, 0.1)
    for source in filter(None, [maps, *sounds]):
        source.emit("end-of-stream")


def finish(pipeline):
    message = pipeline.get_bus().timed_pop_filtered(600 * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    if message is None or message.type == Gst.MessageType.ERROR:
        sys.exit(f"a pipeline fails: {message.parse_error() if message else 'no end within ten minutes'}")
    pipeline.set_state(Gst.State.NULL)


def half_way(channel):
    """Samples at which a channel's envelope crosses half of its steady level."""
    power = numpy.concatenate([[0], numpy.cumsum(channel.astype(float) ** 2)])
    envelope = numpy.sqrt((power[WINDOW:] - power[:-WINDOW]) / WINDOW)
    above = envelope > numpy.percentile(envelope, 90) / 2
    return numpy.flatnonzero(above[1:] != above[:-1])


# No limits and rise times: what is measured is the time of the sound.
MAPS = f" appsrc name=maps format=time max-bytes=0 caps=application/x-tactile-map,rows=1,columns=1,framerate=25/1 ! queue {ROOM} !"
PLAIN = f"mapping=0 frequency={TONE} rise-time=0 ramp-in=0 max-on-time=0 max-duty=0"
SOUND = f"audio/x-raw,format=F32LE,rate={RATE},channels=2,layout=interleaved,channel-mask=(bitmask)3"


def sound(name, sink="pulsesink"):
    return f" appsrc name={name} format=time max-bytes=0 caps={SOUND} ! queue {ROOM} ! {sink}"


LINES = {
    "tactilesynth, by a mixer, in the sound's own sink": f"{MAPS} tactilesynth {PLAIN} ! {SOUND} ! mix. audiomixer name=mix ! pulsesink {sound('right', 'mix.')}",
    "tactoraudiosink, a sink of its own": f"{MAPS} tactoraudiosink {PLAIN} audio-sink=pulsesink {sound('right')}",
    "another sound, a sink of its own": sound("left") + sound("right"),
    "the same after audioconvert": sound("left", "audioconvert ! pulsesink") + sound("right"),
}


def play(line, steps, work):
    recorder = Gst.parse_launch(f"pulsesrc device=null.monitor ! audio/x-raw,format=F32LE,rate={RATE},channels=2 ! queue {ROOM} ! filesink location={work}/heard")
    recorder.set_state(Gst.State.PLAYING)
    recorder.get_state(10 * Gst.SECOND)
    player = Gst.parse_launch(line)
    fill(player, steps)
    player.set_state(Gst.State.PLAYING)
    finish(player)  # half a second after the last switch, by which the monitor is not behind
    recorder.send_event(Gst.Event.new_eos())
    finish(recorder)
    heard = numpy.fromfile(f"{work}/heard", "<f4").reshape(-1, 2)
    left, right = half_way(heard[:, 0]), half_way(heard[:, 1])
    if len(left) != 2 * steps or len(right) != 2 * steps:
        sys.exit(f"expected {2 * steps} switches on each channel, heard {len(left)} and {len(right)}")
    return (left - right) / RATE * 1000


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--steps", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        os.environ.update({"XDG_RUNTIME_DIR": work, "HOME": work, "PULSE_SERVER": f"unix:{work}/socket"})
        # It is ready when its parent has ended.
        started = subprocess.run(["pulseaudio", "-n", "--daemonize=yes", "--exit-idle-time=-1", "--use-pid-file=no", "--log-level=error", "--realtime=no",
                                  "--load=module-null-sink sink_name=null rate=48000", f"--load=module-native-protocol-unix socket={work}/socket auth-anonymous=1"])
        if started.returncode:
            sys.exit("PulseAudio does not start: expected the Debian package pulseaudio")
        try:
            Gst.init(None)
            print("| beside a sound | starts | switches | later by, median | within a start, at most | error p50 | p95 | most |\n|---|---|---|---|---|---|---|---|")
            for what, line in LINES.items():
                late = [play(line, options.steps, work) for _ in range(options.runs)]
                within = max(run.max() - run.min() for run in late)
                error = numpy.percentile(numpy.abs(late), [50, 95, 100])
                print(f"| {what} | {options.runs} | {numpy.size(late)} | {numpy.median(late):+.2f} ms | {within:.2f} ms | "
                      + " | ".join(f"{value:.2f} ms" for value in error) + " |", flush=True)
        finally:
            subprocess.run(["pactl", "exit"], check=False)


if __name__ == "__main__":
    main()
