// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace saliency {

/// Color rarity, the self-information of a color in its picture: R = max(0, -ln(h + 10⁻⁴) / 5) in
/// [0, 1.85], where h in [0, 1] is the share of the picture that has about that color. The
/// commonest color of a plain picture has R = 0.
///
/// Colors are counted in 16 × 16 × 16 bins: L* in [0, 100] evenly, a* and b* by a/(|a| + 24), which
/// gives grays narrow bins (2.8 at 0) and yet has room for all colors, |a| ≤ 112. h sums the
/// counts about a pixel's bin with the weights [½ 1 ½] along each axis, so noise that carries a
/// color over a bin's edge does not make it rare.
class Rarity
{
public:
  /// `border`: compare with the picture's outer frame alone, which takes this share of the width on
  /// either side and of the height likewise, at least one sample; in (0, 0.5]. 0: with the whole
  /// picture.
  explicit Rarity(double border = 0);

  /// `lab`: finite, not empty. `weight` becomes CV_32FC1 of its size, finite, ≥ 0.
  void operator()(const LabImage &lab, cv::Mat &weight);

private:
  double border_;
  std::vector<std::uint16_t> bins_; ///< of each pixel
  std::vector<float> histogram_;
  std::vector<float> table_; ///< smoothed histogram, then R, by bin
};

} // namespace saliency
