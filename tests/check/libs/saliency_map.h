// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_mapping.h"

#include <algorithm>
#include <cmath>
#include <vector>

/// A saliency map, painted by a test.
struct Map
{
  int width;
  int height;
  std::vector<float> values;

  Map(int w, int h, float value = 0)
      : width(w), height(h),
        values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value)
  {
  }

  float &at(int x, int y)
  {
    return values[static_cast<std::size_t>(y * width + x)];
  }

  Map &square(int x0, int y0, int x1, int y1, float value)
  {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        at(x, y) = value;
    return *this;
  }

  /// A square of `side` samples about a place given as shares of the map.
  Map &spot(double x, double y, int side, float value)
  {
    const int left = static_cast<int>(std::lround(x * width - side / 2.0));
    const int top = static_cast<int>(std::lround(y * height - side / 2.0));
    return square(std::max(0, left), std::max(0, top), std::min(width, left + side),
                  std::min(height, top + side), value);
  }

  tactile::SaliencyView view() const
  {
    return { values.data(), width, height, width };
  }
};
