// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A film in any format for tests of saliencytactile, and what its maps say.
#pragma once

#include <algorithm>
#include <vector>

// After the standard library's headers: gstcheck.h defines a macro named fail.
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kBall = 24; // side of the square "ball": fits into a cell of the cropped picture, too

/// A grey RGB frame with a reddish square, weak enough not to saturate the levels, at (x, y), or none if x < 0.
inline GstBuffer *
rgb_frame(const GstVideoInfo &info, int x, int y)
{
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE));
  for (int row = 0; row < GST_VIDEO_INFO_HEIGHT(&info); row++) {
    guint8 *line = static_cast<guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0))
                   + row * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
    for (int column = 0; column < GST_VIDEO_INFO_WIDTH(&info); column++) {
      const bool inside
          = x >= 0 && column >= x && column < x + kBall && row >= y && row < y + kBall;
      line[3 * column] = inside ? 130 : 110;
      line[3 * column + 1] = inside ? 96 : 110;
      line[3 * column + 2] = inside ? 96 : 110;
    }
  }
  gst_video_frame_unmap(&frame);
  return buffer;
}

/// The film of the tests in any format, by videoconvert: 12 still frames, then a square appears in
/// the cell (row, column) of 3 × 3.
inline std::vector<GstBuffer *>
film(const char *format, int row, int column, GstCaps **caps_out, int width = kWidth,
     int height = kHeight)
{
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_RGB, static_cast<guint>(width),
                            static_cast<guint>(height));
  info.fps_n = 30;
  info.fps_d = 1;
  GstCaps *from = gst_video_info_to_caps(&info);
  g_autofree gchar *line
      = g_strdup_printf("videoconvert ! capsfilter caps=video/x-raw,format=%s", format);
  GstHarness *h = gst_harness_new_parse(line);
  gst_harness_set_src_caps(h, from);
  std::vector<GstBuffer *> frames;
  for (int i = 0; i < 16; i++) {
    GstBuffer *frame = i < 12 ? rgb_frame(info, -1, 0)
                              : rgb_frame(info, (2 * column + 1) * width / 6 - kBall / 2,
                                          (2 * row + 1) * height / 6 - kBall / 2);
    GST_BUFFER_PTS(frame) = gst_util_uint64_scale(static_cast<guint64>(i), GST_SECOND, 30);
    GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    frames.push_back(gst_harness_pull(h));
  }
  GstPad *pad = gst_element_get_static_pad(h->element, "src");
  *caps_out = gst_pad_get_current_caps(GST_PAD_PEER(h->sinkpad));
  gst_object_unref(pad);
  gst_harness_teardown(h);
  return frames;
}

inline std::vector<gfloat>
levels_of(GstBuffer *buffer)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  fail_unless(meta != nullptr, "no GstTactileMeta");
  return { meta->levels, meta->levels + meta->rows * meta->columns };
}

/// Plays a film through an element and returns the levels of its last frame.
inline std::vector<gfloat>
play(GstHarness *h, GstCaps *caps, const std::vector<GstBuffer *> &frames)
{
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  std::vector<gfloat> levels;
  for (GstBuffer *frame : frames) {
    fail_unless_equals_int(gst_harness_push(h, gst_buffer_ref(frame)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    levels = levels_of(out);
    gst_buffer_unref(out);
  }
  return levels;
}

inline void
release(std::vector<GstBuffer *> &frames, GstCaps *caps)
{
  for (GstBuffer *frame : frames)
    gst_buffer_unref(frame);
  frames.clear();
  gst_caps_unref(caps);
}

inline std::size_t
strongest(const std::vector<gfloat> &levels)
{
  return static_cast<std::size_t>(std::ranges::max_element(levels) - levels.begin());
}
