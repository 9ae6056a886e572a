// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/profile.h"

#include <opencv2/core/mat.hpp>

namespace saliency {

/// Habituation: what appeared and stands still, such as a title, draws the eye for a moment only.
class Habituation
{
public:
  /// What has become familiar leaves the map within this time, in frames at 30 fps.
  static constexpr double kFading = 9;

  explicit Habituation(const Profile &profile);

  /// Adds the next spatial saliency map (CV_32FC1), `elapsed` frames at 30 fps after the last one.
  ///
  /// Returns by which share each sample's past is to become its present (TemporalPyramid::settle),
  /// or an empty map if no sample's does.
  const cv::Mat &settled(const cv::Mat &map, double elapsed);

  /// Drops the past: all samples begin to stand still now.
  void reset();

private:
  double after_;
  float contrast_;
  float share_of_itself_;
  bool begun_ = false;
  cv::Mat1f first_; ///< of each sample since it stands still
  cv::Mat1f age_;   ///< since then, in frames
  cv::Mat share_;
  cv::Mat none_;
};

} // namespace saliency
