#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The public library as an application in Python sees it, through GObject introspection."""
import math
import struct
import unittest

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstTactile", "1.0")
from gi.repository import Gst, GstTactile  # noqa: E402

LEVELS = [0.0, 0.25, 0.5, 0.75, 1.0, 0.125]


class TactileMeta(unittest.TestCase):
    def test_add_read_and_copy(self):
        buffer = Gst.Buffer.new()
        self.assertIsNone(GstTactile.buffer_get_tactile_meta(buffer))
        meta = GstTactile.buffer_add_tactile_meta(buffer, 2, 3, LEVELS)
        self.assertEqual((meta.rows, meta.columns), (2, 3))
        self.assertEqual(meta.get_levels(), LEVELS)
        self.assertEqual(meta.get_level(1, 0), 0.75)

        copy = buffer.copy()
        del buffer, meta
        survived = GstTactile.buffer_get_tactile_meta(copy)
        self.assertEqual((survived.rows, survived.columns), (2, 3))
        self.assertEqual(survived.get_levels(), LEVELS)

    def test_values_are_clamped(self):
        buffer = Gst.Buffer.new()
        meta = GstTactile.buffer_add_tactile_meta(buffer, 1, 3, [-1, 2, math.nan])
        self.assertEqual(meta.get_levels(), [0, 1, 0])


class SaliencyMeta(unittest.TestCase):
    def test_add_read_and_copy(self):
        buffer = Gst.Buffer.new()
        GstTactile.buffer_add_saliency_meta(buffer, 3, 2, [0, 1, 2, 3, 4, 5], 0.5)
        copy = buffer.copy()
        meta = GstTactile.buffer_get_saliency_meta(copy)
        self.assertEqual((meta.width, meta.height, meta.floor), (3, 2, 0.5))
        self.assertEqual(meta.get_values(), [0, 1, 2, 3, 4, 5])
        self.assertEqual(meta.get_value(2, 1), 5)


class TactileStream(unittest.TestCase):
    def test_caps(self):
        caps = GstTactile.tactile_map_caps_new(3, 4, 30000, 1001)
        self.assertEqual(caps.get_structure(0).get_name(), GstTactile.TACTILE_MAP_MEDIA_TYPE)
        self.assertEqual(tuple(GstTactile.tactile_map_caps_parse(caps)), (True, 3, 4, 30000, 1001))
        self.assertTrue(caps.is_subset(Gst.Caps.from_string(GstTactile.TACTILE_MAP_CAPS)))
        self.assertFalse(GstTactile.tactile_map_caps_parse(Gst.Caps.from_string("video/x-raw"))[0])

    def test_buffers(self):
        buffer = GstTactile.tactile_map_buffer_new(LEVELS)
        self.assertEqual(buffer.extract_dup(0, buffer.get_size()), struct.pack("<6f", *LEVELS))
        self.assertEqual(tuple(GstTactile.tactile_map_buffer_get_levels(buffer, 2, 3)), (True, LEVELS))
        self.assertEqual(tuple(GstTactile.tactile_map_buffer_get_levels(buffer, 3, 3)), (False, []))


if __name__ == "__main__":
    Gst.init(None)
    unittest.main()
