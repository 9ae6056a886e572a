#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Invalid input causes errors or warnings, in a process in which nothing may throw.

OpenCV's and SciPy's Python modules are imported first. On Debian, libstdc++ then uses libunwind's _Unwind_* instead of libgcc's, once
GStreamer has loaded libunwind, and any C++ exception ends in std::terminate. So the process survives only if properties, caps, files and
boards are refused without exceptions. A frame larger than the free memory ends any process, by GStreamer's allocator.

Usage: opencv_first.py PLUGINS [texts] [properties] [frames] [streams] [boards]   (all of them)
"""
import cv2  # first, see above; the test fails if they are missing
import scipy.linalg

import os
import pathlib
import struct
import sys
import tempfile

import gi

gi.require_version('Gst', '1.0')
gi.require_version('GstApp', '1.0')
from gi.repository import GLib, GObject, Gst, GstApp

PATIENCE = 60 * Gst.SECOND  # a bound, not a measure
MAP_CAPS = 'application/x-tactile-map,rows=1,columns=2,framerate=(fraction)5/1'
TEXTS = ['', 'x', ' ', 'face=100', 'face=1,face=1', '=,=', ',' * 5000, '0,1,2', '0,0', '-1', '1e999', 'nan', 'inf', '%n%s',
         '99999999999999999999', '\x01\x02', 'é' * 300, 'a' * 100000, '/nowhere/file', '/', '/dev/null', 'simulator', 'video/x-raw']
NUMBERS = ['-1', '1e999', '-1e999', 'nan', 'inf', '99999999999999999999999', '-99999999999999999999999', 'x', '', '1/0']
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print('FAILED:', what, flush=True)


class Play:
    """A pipeline's messages until it ends, or until it reaches `state`."""

    def __init__(self, line, feed=(), state=Gst.State.PLAYING):
        print('  ' + line[:150].encode('ascii', 'backslashreplace').decode(), flush=True)
        self.errors, self.warnings, self.ended = [], [], False
        try:
            self.pipeline = Gst.parse_launch(line)
        except GLib.Error as error:
            self.errors.append(error.message)
            return
        self.pipeline.set_property('auto-flush-bus', False)  # messages of the stop count, too
        bus = self.pipeline.get_bus()
        changed = self.pipeline.set_state(state)
        for source, samples in feed:
            appsrc = self.pipeline.get_by_name(source)
            for sample in samples:
                appsrc.push_sample(sample)
            appsrc.end_of_stream()
        while changed != Gst.StateChangeReturn.FAILURE and not (self.errors or self.ended):
            message = bus.timed_pop_filtered(PATIENCE, Gst.MessageType.ERROR | Gst.MessageType.WARNING | Gst.MessageType.EOS
                                             | Gst.MessageType.ASYNC_DONE)
            if message is None:
                failures.append('no end of ' + line)
                break
            self.hear(message)
            if message.type == Gst.MessageType.ASYNC_DONE and state != Gst.State.PLAYING:
                break
        self.pipeline.set_state(Gst.State.NULL)
        while message := bus.pop():
            self.hear(message)

    def hear(self, message):
        if message.type == Gst.MessageType.ERROR:
            self.errors.append(message.parse_error()[0].message)
        elif message.type == Gst.MessageType.WARNING:
            self.warnings.append(message.parse_warning()[0].message)
        elif message.type == Gst.MessageType.EOS:
            self.ended = True


def sample(data, caps, pts=0, duration=200 * Gst.MSECOND):
    buffer = Gst.Buffer.new_wrapped(data) if data else Gst.Buffer.new()
    buffer.pts, buffer.duration = pts, duration
    return Gst.Sample.new(buffer, Gst.Caps.from_string(caps), None, None)


def own_factories(folder):
    registry = Gst.Registry.get()
    for feature in registry.get_feature_list(Gst.ElementFactory):
        plugin = feature.get_plugin()
        if plugin and plugin.get_filename() and pathlib.Path(plugin.get_filename()).is_relative_to(folder):
            yield feature.get_name()


def own_properties(element):
    """Writable properties of the element, inherited ones included."""
    for spec in element.list_properties():
        if spec.flags & GObject.ParamFlags.WRITABLE and not spec.flags & GObject.ParamFlags.CONSTRUCT_ONLY and spec.name not in ('name', 'parent'):
            yield spec


def start_and_stop(element):
    """Starts an element alone: some properties take effect only there."""
    element.set_state(Gst.State.PAUSED)
    element.set_state(Gst.State.NULL)


def try_properties(name):
    element = Gst.ElementFactory.make(name)
    names = [spec.name for spec in own_properties(element)]
    for property_name in names:
        print('  %s %s' % (name, property_name), flush=True)
        element = Gst.ElementFactory.make(name)
        if name == 'visuotactilesink':
            element.set_property('video-sink', Gst.ElementFactory.make('fakesink'))
        spec = element.find_property(property_name)
        kind = spec.value_type
        if kind == GObject.TYPE_STRING:
            for text in TEXTS:
                element.set_property(property_name, text)
                element.get_property(property_name)
                if name != 'visuotactilesink':  # it passes them to tactorsink, and is slow to find a window
                    start_and_stop(element)
            element.set_property(property_name, None)
            start_and_stop(element)
        elif hasattr(spec, 'minimum'):
            for value in (spec.minimum, spec.maximum):
                element.set_property(property_name, value)
            for text in NUMBERS:
                Gst.util_set_object_arg(element, property_name, text)
                value = element.get_property(property_name)
                check(spec.minimum <= value <= spec.maximum, '%s %s=%s is %r' % (name, property_name, text, value))
            start_and_stop(element)
        else:
            for text in ('no-such-thing', '999999', '-1', ''):
                if kind.is_a(GObject.TYPE_ENUM) or kind.is_a(GObject.TYPE_BOOLEAN) or kind.is_a(Gst.Caps.__gtype__):
                    Gst.util_set_object_arg(element, property_name, text)
                    element.get_property(property_name)
            start_and_stop(element)


def try_wrong_texts():
    """Properties whose warnings and errors are documented."""
    weights = Gst.parse_launch('pipeline ( tactiletestsrc ! saliencytactile name=s ! fakesink )')
    element = weights.get_by_name('s')
    element.set_property('roi-weights', 'face=2')
    for text in ('face=100', 'face', 'face=1,face=2', '=1', 'face=nan'):
        element.set_property('roi-weights', text)
        message = weights.get_bus().timed_pop_filtered(PATIENCE, Gst.MessageType.WARNING)
        check(message and 'roi-weights stay as they were' in message.parse_warning()[0].message, 'no warning of ' + text)
        check(element.get_property('roi-weights') == 'face=2', 'roi-weights are no longer face=2 after ' + text)
    check(Play('tactiletestsrc num-buffers=3 ! saliencytactile roi-weights=face=100 ! fakesink').errors, 'it played with face=100')


def try_frames():
    def picture(width, height, n):
        stride = (width + 3) // 4 * 4
        return sample(bytes((i * 7 + n) % 251 for i in range(stride * height)),
                      'video/x-raw,format=GRAY8,width=%d,height=%d,framerate=25/1' % (width, height), n * 40 * Gst.MSECOND, 40 * Gst.MSECOND)

    sizes = [(1, 1), (2, 1), (1, 3), (5, 7), (64, 48), (32767, 1), (1, 32767), (1, 1), (640, 3), (17, 129)]
    for settings in ('', 'profile=paper', 'temporal=false attach-saliency=true', 'exact=true n-threads=64 viewport=adaptive roi-weights=*=10',
                     'rows=64 columns=64 max-rate=0.001'):
        play = Play('appsrc name=in format=time ! saliencytactile %s ! tactileoverlay style=heatmap ! tactileextractor name=x '
                    'x.src ! queue ! fakesink sync=false x.tactile ! queue ! tactorsink driver=simulator sync=false' % settings,
                    [('in', [picture(*size, n) for n, size in enumerate(sizes)])])
        check(play.ended and not play.errors, 'frames of any size with %s: %s' % (settings, play.errors))
    for form in ('I420', 'NV12', 'YUY2', 'UYVY', 'RGB', 'RGBA', 'P010_10LE', 'I420_10LE'):
        for size in ('width=1,height=1', 'width=3,height=5', 'width=4099,height=3'):
            play = Play('videotestsrc num-buffers=2 ! video/x-raw,format=%s,%s ! saliencytactile attach-saliency=true ! fakesink'
                        % (form, size))
            check(play.ended or play.errors == ['Internal data stream error.'], '%s %s: %s' % (form, size, play.errors))


def try_streams():
    maps = [sample(struct.pack('<2f', 0.5, 1), MAP_CAPS), sample(b'', MAP_CAPS, 1), sample(b'123', MAP_CAPS, 2),
            sample(struct.pack('<2f', float('nan'), -3), MAP_CAPS, 3)]
    text = 'text/x-raw,format=utf8'
    texts = [sample(data, text, n * Gst.SECOND) for n, data in enumerate(
        [b'0 100', b'Hello, world', b'', b'\0', b'101', b'1 2\n3', b'nan', b'1e5', b'\xff\xfe', b'1 ' * 5000, b'-->' * 9, b'50\n' * 5000])]
    klv = 'meta/x-klv,parsed=true'
    key = bytes([6, 14, 43, 52, 2, 5, 1, 1, 15]) + b'TACTILE'
    whole = key + bytes([19, 1, 1, 2]) + struct.pack('>q2f', 10 ** 9, 0.5, 1)
    packets = [sample(data, klv, n * Gst.SECOND) for n, data in enumerate(
        [whole, b'', key, key + b'\x80', key + b'\xff', key + b'\x88' + b'\xff' * 8, whole[:-1], whole + b'x', b'x' + whole,
         whole[:17] + b'\x02' + whole[18:], whole[:18] + b'\x00' + whole[19:], whole[:28] + b'\x7f' + whole[29:]])]
    for samples in (maps, texts, packets):
        for to in ('application/x-tactile-map', 'text/x-raw', 'meta/x-klv'):
            caps = samples[0].get_caps().get_structure(0).get_name()
            if caps == to:
                continue
            play = Play('appsrc name=in format=time ! tactileconverter ! %s ! fakesink sync=false' % to, [('in', samples)])
            check(play.ended and len(play.warnings) == 1, '%s to %s: %s %s' % (caps, to, play.errors, play.warnings))
    for samples in (texts, texts[1:2]):
        play = Play('videotestsrc num-buffers=20 ! tactilesubtitles name=t ! fakesink sync=false appsrc name=in format=time ! t.text_sink',
                    [('in', samples)])
        check(play.ended and not play.errors, 'subtitles: %s' % play.errors)
    if Gst.ElementFactory.find('tactileklvdec'):
        play = Play('appsrc name=in format=time ! tactileklvdec ! fakesink sync=false', [('in', packets)])
        check(play.ended, 'tactileklvdec: %s' % play.errors)
    other = sample(struct.pack('<6f', *([0.5] * 6)), MAP_CAPS.replace('rows=1,columns=2', 'rows=2,columns=3'), 5)
    for sink in ('tactorsink driver=simulator sync=false', 'tactileconverter ! text/x-raw ! fakesink'):
        check(Play('appsrc name=in format=time ! ' + sink, [('in', maps[:1] + [other] + maps)]), 'caps that change')


def try_calibrations(folder):
    head = '[Calibration]\nversion=1\n'
    tactor = head + '[Tactor 0]\n'
    wrong = ['', 'x', head, 'version=1', '[Calibration]\nversion=2\n', head + '[Tactor x]\n', head + '[Tactor -1]\n', tactor + 'latency-ms=soon',
             tactor + 'latency-ms=nan', tactor + 'start-volts=0.4\nhold-volts=0.5', tactor + 'rise-table-step-volts=0.1\nrise-table-ms=1;2;3;',
             tactor + 'rise-table-ms=1;2;3;4;', tactor + 'rise-quadratic-ms=1;2;3;', tactor + 'rise-model=cubic',
             tactor + 'vibration-volts=1;2;\nvibration=1;', tactor + 'vibration-volts=1;2;\nvibration=2;1;', '\n' * 300000, 'a' * (2 << 20)]
    for n, text in enumerate(wrong):
        path = folder / ('%d.calibration' % n)
        path.write_text(text)
        refused('tactorsink driver=simulator calibration=%s' % path)
    for path in (folder, '/nowhere/none', '/dev/zero'):
        refused('tactorsink driver=simulator calibration=%s' % path)


def refused(sink):
    play = Play('appsrc name=in format=time caps=%s ! %s' % (MAP_CAPS, sink), state=Gst.State.PAUSED)
    check(play.errors, 'not refused: ' + sink)


def try_drivers(folder):
    for driver in ('', 'none', 'no-such-driver', 'x' * 10000):
        refused('tactorsink driver="%s"' % driver)
    for driver in ('firmata', 'seat'):
        for device in ('', '9-9', 'no such board', '/dev/null'):
            refused('tactorsink driver=%s device="%s"' % (driver, device))
    same = folder / 'same.csv'
    for settings in ('driver=simulator device=%s' % folder, 'driver=simulator device=/nowhere/x.csv', 'driver=simulator trace-location=/nowhere/x.csv',
                     'driver=simulator trace-location=%s' % folder, 'driver=simulator device=%s trace-location=%s' % (same, same)):
        refused('tactorsink ' + settings)
    play = Play('appsrc name=in format=time ! tactorsink driver=auto device=9-9 sync=false', [('in', [sample(struct.pack('<2f', 0.5, 1), MAP_CAPS)])])
    check(play.ended or play.errors, 'auto has no answer')
    full = '/dev/full'
    play = Play('appsrc name=in format=time ! tactorsink driver=simulator sync=false trace-location=' + full,
                [('in', [sample(struct.pack('<2f', i % 2, 1), MAP_CAPS, i * 200 * Gst.MSECOND) for i in range(200)])])
    check(play.errors or play.warnings, 'a full disk has no answer')
    for uri in ('tactor://', 'tactor:', 'tactor://x?driver=y', 'tactor://simulator?rate=nan&rate=', 'tactor://%00', 'tactor:///' + 'x' * 5000):
        try:
            start_and_stop(Gst.Element.make_from_uri(Gst.URIType.SINK, uri, None))
        except GLib.Error:
            pass
    provider = Gst.DeviceProviderFactory.find('tactordeviceprovider')
    if provider:
        provider = provider.get()
        check(provider.start(), 'the device provider does not start')
        provider.get_devices()
        provider.stop()


def try_files_and_boards():
    folder = pathlib.Path.cwd()
    try_calibrations(folder)
    try_drivers(folder)


def main():
    Gst.init(None)
    plugins = pathlib.Path(sys.argv[1]).resolve()

    def try_all_properties():
        names = sorted(own_factories(plugins))
        check(len(names) >= 9, 'elements: %s' % names)
        for name in names:
            try_properties(name)

    parts = {'texts': try_wrong_texts, 'properties': try_all_properties, 'frames': try_frames, 'streams': try_streams,
             'boards': try_files_and_boards}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # some texts name files to write
        for name in sys.argv[2:] or parts:
            parts[name]()
        os.chdir('/')
    print('%d failures' % len(failures))
    return 1 if failures else 0


if __name__ == '__main__':
    sys.exit(main())
