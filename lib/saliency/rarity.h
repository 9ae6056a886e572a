// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace saliency {

/// Color rarity, the self-information of a color in its picture: R = max(0, -ln(h + 10⁻⁴) / 5) in
/// [0, 1.85]. h in [0, 1] is the share of the picture that has about this color. The most common
/// color of a plain picture has R = 0.
///
/// Colors are counted in 16 × 16 × 16 bins: L* in [0, 100] evenly, a* and b* by a/(|a| + 24). That
/// gives grays narrow bins (2.8 at 0) and still covers all colors, |a| ≤ 112. h sums the counts
/// around a pixel's bin with weights [½ 1 ½] along each axis, so that noise across the edge of a
/// bin does not make a color rare.
class Rarity
{
public:
  /// `border` in (0, 0.5]: compare with the outer frame of the picture only, this share of the
  /// width and height on each side, at least one sample. 0: compare with the whole picture.
  explicit Rarity(double border = 0);

  /// `lab`: finite, not empty. `weight` becomes CV_32FC1 of its size, finite and ≥ 0.
  void operator()(const LabImage &lab, cv::Mat &weight);

private:
  double border_;
  std::vector<std::uint16_t> bins_; ///< per pixel
  std::vector<float> histogram_;
  std::vector<float> table_; ///< smoothed histogram, then R
};

} // namespace saliency
