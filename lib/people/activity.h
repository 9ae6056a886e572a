// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

namespace people {

/// Measures to and fro changes of each part of the picture beyond noise: a mouth that talks, whose
/// contrast is no event. A fade goes one way and does not count; nothing counts while the camera
/// moves.
class Activity
{
public:
  /// Adds a frame: its lightness, CV_32FC1 and continuous. `elapsed`: seconds since the last frame.
  void add(const cv::Mat &lightness, double elapsed, bool camera_moves);

  /// At a coarser level of the lightness' pyramid, of size `map`: the mean change over half a
  /// second, in ΔL* each 1/30 s, less that of one sign, less twice its upper quartile, at least 0.
  const cv::Mat1f &beyond_noise(cv::Size map);

  void reset()
  {
    last_.release();
  }

private:
  cv::Mat last_;
  cv::Mat1f change_; ///< mean of |ΔL*|
  cv::Mat1f drift_;  ///< mean of ΔL*
  cv::Mat1f beyond_;
  std::vector<float> sorted_;
};

} // namespace people
