// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Frames in memory for tests of the whole analysis.

#include "frame/frame_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace oracle {

/// An 8-bit I420 frame.
struct Frame
{
  int width;
  int height;
  std::array<std::vector<std::uint8_t>, 3> planes;

  Frame(int w, int h, std::uint8_t gray = 128) : width(w), height(h)
  {
    planes[0].assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), gray);
    planes[1].assign(static_cast<std::size_t>((w + 1) / 2) * static_cast<std::size_t>((h + 1) / 2),
                     128);
    planes[2] = planes[1];
  }

  int plane_width(std::size_t c) const
  {
    return c == 0 ? width : (width + 1) / 2;
  }

  int plane_height(std::size_t c) const
  {
    return c == 0 ? height : (height + 1) / 2;
  }

  std::uint8_t &at(std::size_t c, int x, int y)
  {
    return planes[c][static_cast<std::size_t>(y * plane_width(c) + x)];
  }

  saliency::FrameView view() const
  {
    saliency::FrameView view;
    view.width = width;
    view.height = height;
    view.matrix = saliency::kBt601;
    for (std::size_t c = 0; c < 3; ++c)
      view.components[c] = { planes[c].data(), plane_width(c), 1, plane_width(c), plane_height(c) };
    return view;
  }

  void disc(double cx, double cy, double radius, std::array<int, 3> color)
  {
    for (std::size_t c = 0; c < 3; ++c)
      for (int y = 0; y < plane_height(c); ++y)
        for (int x = 0; x < plane_width(c); ++x) {
          const int step = c == 0 ? 1 : 2;
          if (std::hypot(x * step - cx, y * step - cy) <= radius)
            at(c, x, y) = static_cast<std::uint8_t>(color[c]);
        }
  }
};

/// A still, textured background. No two samples of its map are equal, so no test depends on how
/// ties are broken.
inline Frame
textured(int width, int height)
{
  Frame frame(width, height);
  std::mt19937 generator(11);
  std::uniform_int_distribution<int> noise(-20, 20);
  for (std::size_t c = 0; c < 3; ++c)
    for (int y = 0; y < frame.plane_height(c); ++y)
      for (int x = 0; x < frame.plane_width(c); ++x)
        frame.at(c, x, y) = static_cast<std::uint8_t>(
            std::lround(120 + 30 * std::sin(0.2 * x + static_cast<double>(c)) * std::cos(0.31 * y)
                        + noise(generator)));
  return frame;
}

/// A ball crosses the picture, stops and vanishes.
inline Frame
film(int width, int height, int i)
{
  Frame frame = textured(width, height);
  if (i >= 4 && i < 24) {
    const double t = std::min(i, 16) / 16.0;
    frame.disc(width * (0.15 + 0.6 * t), height * (0.7 - 0.4 * t), height * 0.15, { 210, 90, 200 });
  }
  return frame;
}

} // namespace oracle
