// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <cstddef>

namespace tactile {

/// A read-only saliency map: `values[y * stride + x]`, 0 ≤ x < width, 0 ≤ y < height. Values are ≥
/// 0; values that are not finite count as 0.
struct SaliencyView
{
  const float *values = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0; ///< floats per row

  /// Extent of the picture along an axis, in samples, where sample i covers [i, i + 1). Samples of
  /// a pyramid level lie on every 2ⁿ-th pixel, so the picture begins about half a sample after the
  /// map. The border is repeated beyond the map.
  struct Extent
  {
    double begin = 0;
    double length = 0; ///< 0: the whole map
  };
  Extent horizontal;
  Extent vertical;

  double strength = 0; ///< of the strongest event, for Gain::relative (saliency::Strength)

  bool empty() const
  {
    return values == nullptr || width < 1 || height < 1;
  }

  double at(int x, int y) const
  {
    const float value = values[y * stride + x];
    return std::isfinite(value) ? static_cast<double>(value) : 0.0;
  }

  /// Maximum; 0 for an empty map.
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
