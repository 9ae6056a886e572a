// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/profile.h"
#include "saliency/temporal_pyramid.h"

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <vector>

namespace saliency {

/// Spatiotemporal saliency ST (paper, Section 3): temporal centre-surround differences, combined
/// like the spatial ones.
class SpatiotemporalSaliency
{
public:
  explicit SpatiotemporalSaliency(const Profile &profile);

  /// Sum or mean over the profile's windows of |T_c - T_s| or max(0, T_c - T_s), optionally
  /// normalised by N(·). CV_32FC1, ≥ 0, valid until the next call. `history` has had at least one
  /// push.
  const cv::Mat &compute(const TemporalPyramid &history);

private:
  /// A pair, by the places of its windows in `windows_`.
  struct Pair
  {
    std::size_t center;
    std::size_t surround;
  };

  TemporalSign sign_;
  bool mean_;
  Normalization normalization_;
  std::vector<int> windows_; ///< each once
  std::vector<Pair> pairs_;
  std::vector<cv::Mat> means_; ///< of windows_
  cv::Mat saliency_;
};

} // namespace saliency
