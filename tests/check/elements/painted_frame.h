// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Frames for saliencytactile that a test paints on a gray ground.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "saliencytactile_rig.h"

constexpr int kGray = 110;
constexpr const char *kCaps = "video/x-raw,format=RGB,width=320,height=240,framerate=30/1";

/// The gray value of a pixel, or -1 for the background.
using Paint = std::function<int(int x, int y)>;

inline GstBuffer *
frame(guint number, const Paint &paint)
{
  std::vector<guint8> pixels(kWidth * kHeight * 3, kGray);
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < kWidth; x++)
      if (const int gray = paint(x, y); gray >= 0)
        std::fill_n(pixels.begin() + 3 * (y * kWidth + x), 3, static_cast<guint8>(gray));
  GstBuffer *buffer = gst_buffer_new_memdup(pixels.data(), pixels.size());
  GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(number, GST_SECOND, 30);
  GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
  return buffer;
}

inline int
nothing(int, int)
{
  return -1;
}

/// A square of `side` pixels about (x, y).
inline Paint
square(int x, int y, int side, int gray = 230)
{
  return [=](int px, int py) {
    return std::abs(2 * (px - x) + 1) <= side && std::abs(2 * (py - y) + 1) <= side ? gray : -1;
  };
}

inline Paint
both(const Paint &a, const Paint &b)
{
  return [=](int x, int y) {
    return std::max(a(x, y), b(x, y));
  };
}

inline bool
any(const std::vector<gfloat> &levels)
{
  return std::ranges::any_of(levels, [](gfloat level) { return level > 0; });
}
