// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/saliency_view.h"

#include <cstddef>
#include <vector>

namespace tactile {

/// A saliency map that covers its picture exactly, as whoever resizes an image expects: the middle
/// of sample (x, y) lies at ((x + ½) / width, (y + ½) / height) of the picture. A pyramid's samples
/// sit on every 2ⁿth pixel, about half a sample before.
class PictureMap
{
public:
  /// Samples a map, by as many samples as it has, along each axis by Keys' cubic (1981, a = −½),
  /// under which what is symmetric stays where it is. Values are ≥ 0; beyond the map its border is
  /// repeated. Allocates only for a larger map.
  void sample(const SaliencyView &map);

  /// As after sample() of an empty map.
  void clear();

  /// Row by row; empty for an empty map.
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
  /// The largest value; 0 for an empty map.
  double peak() const;

private:
  std::vector<float> values_;
  std::vector<double> rows_; ///< sampled along the rows: width × the map's height
  int width_ = 0;
  int height_ = 0;
};

} // namespace tactile
