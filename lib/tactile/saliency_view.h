// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <cstddef>

namespace tactile {

/// A saliency map to read: `values[y * stride + x]`, 0 ≤ x < width, 0 ≤ y < height. Values are ≥ 0;
/// those that are not finite count as 0.
struct SaliencyView
{
  const float *values = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0; ///< floats from row to row

  /// Where the picture lies along an axis of the map, in samples of which sample i covers
  /// [i, i + 1). A pyramid's samples sit on every 2ⁿth pixel, so its picture begins about half a
  /// sample after the map. Beyond the map its border is repeated.
  struct Extent
  {
    double begin = 0;
    double length = 0; ///< 0: the whole map
  };
  Extent horizontal;
  Extent vertical;

  bool empty() const
  {
    return values == nullptr || width < 1 || height < 1;
  }

  double at(int x, int y) const
  {
    const float value = values[y * stride + x];
    return std::isfinite(value) ? static_cast<double>(value) : 0.0;
  }

  /// The largest value; 0 for an empty map.
  double peak() const
  {
    double peak = 0;
    if (!empty())
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          peak = at(x, y) > peak ? at(x, y) : peak;
    return peak;
  }
};

} // namespace tactile
