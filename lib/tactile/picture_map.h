// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/saliency_view.h"

#include <vector>

namespace tactile {

/// A saliency map resampled to cover its picture exactly, as for image resizing: the center of
/// sample (x, y) lies at ((x + ½) / width, (y + ½) / height) of the picture. Samples of a pyramid
/// level lie on every 2ⁿ-th pixel instead, about half a sample earlier.
class PictureMap
{
public:
  /// Resamples a map to the same number of samples, by Keys' cubic along each axis (1981, a = −½),
  /// which preserves symmetry. Values are ≥ 0; the border is repeated beyond the map. Allocates
  /// only for a larger map.
  void sample(const SaliencyView &map);

  /// Like sample() of an empty map.
  void clear();

  /// Row-major; empty for an empty map.
  const std::vector<float> &values() const
  {
    return values_;
  }
  int width() const
  {
    return width_;
  }
  int height() const
  {
    return height_;
  }
  /// Maximum; 0 for an empty map.
  double peak() const;

private:
  std::vector<float> values_;
  std::vector<double> rows_; ///< resampled along rows: width × the source's height
  int width_ = 0;
  int height_ = 0;
};

} // namespace tactile
