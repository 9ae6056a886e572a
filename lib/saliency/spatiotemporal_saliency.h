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

  /// Sum or mean over the profile's windows of |T_c - T_s| or max(0, T_c - T_s), minus the
  /// background, optionally normalized by N(·). CV_32FC1, ≥ 0, valid until the next call and free
  /// to be changed. Requires
  /// at least one push to `history`. If the camera moved, surrounds are dilated and scaled and the
  /// rim is zero (Profile::camera_dilation, camera_margin, camera_rim).
  cv::Mat &compute(TemporalPyramid &history, const Team &team = {});

private:
  /// A window pair as indices into `windows_`.
  struct Pair
  {
    std::size_t center;
    std::size_t surround;
  };

  static float illumination(const cv::Mat &center, const cv::Mat &surround,
                            std::vector<float> &sorted);
  void subtract_background(const cv::Rect &within, float raised);

  TemporalSign sign_;
  bool mean_;
  bool illumination_guard_;
  int camera_dilation_;
  double camera_margin_;
  int camera_rim_;
  float camera_background_;
  double background_gain_;
  double background_quantile_;
  double background_limit_;
  Normalization normalization_;
  std::vector<int> windows_; ///< sorted, unique
  std::vector<Pair> pairs_;
  std::vector<float> light_;   ///< β per pair
  std::vector<cv::Mat> means_; ///< per window
  cv::Mat along_rows_;         ///< surrounds dilated along one axis
  cv::Mat dilated_;
  std::vector<std::vector<float>> sorted_; ///< scratch space per pair
  cv::Mat saliency_;
};

} // namespace saliency
