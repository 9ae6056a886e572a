// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/profile.h"
#include "saliency/temporal_pyramid.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <cstddef>
#include <vector>

namespace saliency {

/// Spatiotemporal saliency ST (paper, Section 3): temporal center-surround differences, combined
/// like the spatial ones.
class SpatiotemporalSaliency
{
public:
  explicit SpatiotemporalSaliency(const Profile &profile);

  /// Sum or mean over the profile's windows of |T_c - T_s| or max(0, T_c - T_s), less what the map
  /// has in common, optionally normalized by N(·). CV_32FC1, ≥ 0, valid until the next call.
  /// `history` has had at least one push. If the camera has moved, surrounds are dilated and count
  /// more, and the rim is silent unless it is the whole map (Profile::camera_dilation,
  /// camera_margin, camera_rim).
  const cv::Mat &compute(TemporalPyramid &history, const Team &team = {});

private:
  /// A pair, by the places of its windows in `windows_`.
  struct Pair
  {
    std::size_t center;
    std::size_t surround;
  };

  static float illumination(const cv::Mat &center, const cv::Mat &surround,
                            std::vector<float> &sorted);
  void take_background_off(const cv::Rect &within);

  TemporalSign sign_;
  bool mean_;
  bool illumination_guard_;
  int camera_dilation_;
  double camera_margin_;
  int camera_rim_;
  double background_gain_;
  double background_quantile_;
  double background_limit_;
  Normalization normalization_;
  std::vector<int> windows_; ///< each once, ascending
  std::vector<Pair> pairs_;
  std::vector<float> light_;   ///< of each pair
  std::vector<cv::Mat> means_; ///< of windows_
  cv::Mat along_rows_;         ///< surrounds dilated along one axis, and along both
  cv::Mat dilated_;
  std::vector<std::vector<float>> sorted_; ///< of each pair
  cv::Mat saliency_;
};

} // namespace saliency
