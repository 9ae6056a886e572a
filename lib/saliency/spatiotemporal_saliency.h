// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/profile.h"
#include "saliency/temporal_pyramid.h"

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <vector>

namespace saliency {

/// Spatiotemporal saliency ST (paper, Section 3): temporal center-surround differences, combined
/// like the spatial ones.
class SpatiotemporalSaliency
{
public:
  explicit SpatiotemporalSaliency(const Profile &profile);

  /// Sum over the profile's windows of |T_c - T_s|, optionally normalized by N(·). CV_32FC1, ≥ 0,
  /// valid until the next call. Requires at least one push to `history`.
  const cv::Mat &compute(const TemporalPyramid &history, const Team &team = {});

private:
  /// A window pair as indices into `windows_`.
  struct Pair
  {
    std::size_t center;
    std::size_t surround;
  };

  Normalization normalization_;
  std::vector<int> windows_; ///< sorted, unique
  std::vector<Pair> pairs_;
  std::vector<cv::Mat> means_; ///< per window
  cv::Mat saliency_;
};

} // namespace saliency
