// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/profile.h"
#include "saliency/pyramid.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace saliency {

/// Contrast maps (paper, Section 3): "upsampling a coarser surround image to the finer center image
/// and subtracting".
class Contrast
{
public:
  /// `chroma_weight` w ≥ 0: the difference is √(ΔL² + w² (Δa² + Δb²)); w = 1 is CIE 1976 ΔE.
  explicit Contrast(double chroma_weight);

  /// C(c, s) = ‖P_c - up(P_s)‖ ≥ 0 in a pyramid of L*a*b* images, surround ≥ center. Differences of
  /// a* and b* are taken from the pair `chroma`, no finer than `lightness`, and brought to the
  /// center's resolution. `map` becomes CV_32FC1 of the size of level lightness.center.
  void operator()(const Pyramid &pyramid, LevelPair lightness, LevelPair chroma, cv::Mat &map,
                  const Team &team = {});

private:
  static const float *enlarged(const cv::Mat &plane, int octaves, int row, int width,
                               std::vector<float> &fine);
  const cv::Mat &chroma_squared(const Pyramid &pyramid, LevelPair pair, const Team &team);

  float chroma_weight_squared_;
  /// Per thread: two rows at the center's resolution.
  std::vector<std::array<std::vector<float>, 2>> fine_;
  std::vector<cv::Mat> chroma_; ///< w² (Δa² + Δb²), by level
};

} // namespace saliency
