// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A film in any format for tests of saliencytactile, and its maps.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kBall = 24; // side of the square, which fits into a cell of the cropped picture, too

/// A gray RGB frame with a reddish square at (x, y), or none if x < 0. The square is too weak to
/// saturate the levels.
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

/// The tests' film in any format, by videoconvert: 12 still frames, then a square appears in the
/// cell (row, column) of 3 × 3 and moves to the right there until the end, by 4 pixels a frame.
class SquareFilm
{
public:
  SquareFilm(const char *format, int row, int column)
  {
    GstVideoInfo info;
    gst_video_info_set_format(&info, GST_VIDEO_FORMAT_RGB, kWidth, kHeight);
    info.fps_n = 30;
    info.fps_d = 1;
    g_autofree gchar *line
        = g_strdup_printf("videoconvert ! capsfilter caps=video/x-raw,format=%s", format);
    GstHarness *h = gst_harness_new_parse(line);
    gst_harness_set_src_caps(h, gst_video_info_to_caps(&info));
    for (int i = 0; i < 16; i++) {
      const int x = (2 * column + 1) * kWidth / 6 - kBall / 2 + 4 * i - 54;
      const int y = (2 * row + 1) * kHeight / 6 - kBall / 2;
      GstBuffer *frame = i < 12 ? rgb_frame(info, -1, 0) : rgb_frame(info, x, y);
      GST_BUFFER_PTS(frame) = gst_util_uint64_scale(static_cast<guint64>(i), GST_SECOND, 30);
      GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
      frames.push_back(gst_harness_push_and_pull(h, frame));
    }
    caps = gst_pad_get_current_caps(GST_PAD_PEER(h->sinkpad));
    gst_harness_teardown(h);
  }
  ~SquareFilm()
  {
    for (GstBuffer *frame : frames)
      gst_buffer_unref(frame);
    gst_caps_unref(caps);
  }
  SquareFilm(const SquareFilm &) = delete;
  SquareFilm &operator=(const SquareFilm &) = delete;

  std::vector<GstBuffer *> frames;
  GstCaps *caps;
};

inline std::vector<gfloat>
levels_of(GstBuffer *buffer)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  fail_unless(meta != nullptr, "no GstTactileMeta");
  return { meta->levels, meta->levels + meta->rows * meta->columns };
}

/// A frame whose bytes all have this value.
inline GstBuffer *
flat_frame(gsize size, guint8 value)
{
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  gst_buffer_memset(buffer, 0, value, size);
  return buffer;
}

/// The size in bytes of a frame with these caps.
inline gsize
frame_size(const char *caps)
{
  g_autoptr(GstCaps) parsed = gst_caps_from_string(caps);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, parsed));
  return GST_VIDEO_INFO_SIZE(&info);
}

/// A saliencytactile, alone or within a launch line.
class Analysis
{
public:
  explicit Analysis(const std::string &line = "saliencytactile", const char *caps = nullptr)
      : h(gst_harness_new_parse(line.c_str())),
        element(gst_harness_find_element(h, "saliencytactile")), messages(element)
  {
    if (caps)
      set_caps(caps);
  }
  ~Analysis()
  {
    gst_object_unref(element);
    gst_harness_teardown(h);
  }
  Analysis(const Analysis &) = delete;
  Analysis &operator=(const Analysis &) = delete;

  void set_caps(const char *caps)
  {
    gst_harness_set_src_caps_str(h, caps);
  }
  void set_caps(GstCaps *caps)
  {
    gst_harness_set_src_caps(h, gst_caps_ref(caps));
  }
  void set(const char *property, const char *value)
  {
    gst_util_set_object_arg(G_OBJECT(element), property, value);
  }
  /// The output for a frame.
  GstBuffer *pass(GstBuffer *frame)
  {
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    return gst_harness_pull(h);
  }
  std::vector<gfloat> felt(GstBuffer *frame)
  {
    g_autoptr(GstBuffer) out = pass(frame);
    return levels_of(out);
  }
  /// The levels of a film's last frame.
  std::vector<gfloat> play(const SquareFilm &film)
  {
    set_caps(film.caps);
    std::vector<gfloat> levels;
    for (GstBuffer *frame : film.frames)
      levels = felt(gst_buffer_ref(frame));
    return levels;
  }
  void push_segment()
  {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  }
  void flush()
  {
    fail_unless(gst_harness_push_event(h, gst_event_new_flush_start()));
    fail_unless(gst_harness_push_event(h, gst_event_new_flush_stop(TRUE)));
    push_segment();
  }

  GstHarness *h;
  GstElement *element;
  ElementBus messages;
};

inline std::size_t
strongest(const std::vector<gfloat> &levels)
{
  return static_cast<std::size_t>(std::ranges::max_element(levels) - levels.begin());
}
