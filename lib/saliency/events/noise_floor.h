// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>

namespace saliency {

/// Motion that continues at one place is no event: rain, leaves, water, a crowd, film grain.
///
/// The noise floor of each place is estimated by minimum statistics (Martin, "Noise power spectral
/// density estimation based on optimal smoothing and minimum statistics", 2001): the least, in the
/// last seven seconds, of the greatest value within a quarter of the map's width. Motion that
/// pauses once in this time has a floor of zero.
class NoiseFloor
{
public:
  /// Lowers `map` (CV_32FC1, ≥ 0), the events `elapsed` frames at 30 fps after the last ones, by
  /// seven times the floor, at most by 14. From a floor of 7 on it is lowered less, from 8 on not
  /// at all: so much is an event. Nothing is lowered in the first seconds.
  void subtract(cv::Mat &map, double elapsed);

  /// Drops the past.
  void reset();

private:
  static constexpr std::size_t kStretches = 6; ///< of time

  bool begun_ = false;
  cv::Mat along_rows_;
  cv::Mat around_;                        ///< largest value around each sample
  cv::Mat smooth_;                        ///< over time
  cv::Mat present_;                       ///< least in the current stretch
  std::array<cv::Mat, kStretches> least_; ///< in past stretches, a ring
  std::size_t next_ = 0;
  std::size_t known_ = 0;
  double age_ = 0; ///< of the current stretch, in frames
};

} // namespace saliency
