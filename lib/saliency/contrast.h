// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

namespace saliency {

/// Contrast maps (paper, Section 3): "upsampling a coarser surround image to the finer center image
/// and subtracting".
class Contrast
{
public:
  /// `chroma_weight` w: the difference is √(ΔL² + w² (Δa² + Δb²)); 1 is CIE 1976 ΔE.
  explicit Contrast(double chroma_weight);

  /// C(c, s) = ‖P_c - up(P_s)‖ ≥ 0. `center` and `surround`: CV_32FC3 L*a*b* images of one pyramid,
  /// the surround coarser by `octaves` ≥ 0. `map` becomes CV_32FC1 of the centre's size.
  void operator()(const cv::Mat &center, const cv::Mat &surround, int octaves, cv::Mat &map);

private:
  float chroma_weight_squared_;
  cv::Mat surround_; ///< at the centre's resolution
};

} // namespace saliency
