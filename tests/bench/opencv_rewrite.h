// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <vector>

namespace bench {

/// The tuned profile with OpenCV alone, optimized: 8-bit color, temporal windows from cumulative
/// sums, area means. Camera motion, cuts and illumination are left out.
class OpencvRewrite
{
public:
  /// With `decimate_first`, pyrDown of the planes, then L*a*b*, as in this project. Otherwise
  /// L*a*b* of every pixel, then pyrDown.
  OpencvRewrite(cv::Size frame, bool decimate_first);

  /// `i420`: CV_8UC1, 3/2 the height. Returns a 3 × 3 map, CV_32FC1.
  const cv::Mat &frame(const cv::Mat &i420);

private:
  void decimated_lab(const cv::Mat &i420);
  void lab_of_every_pixel(const cv::Mat &i420);

  static constexpr std::size_t kLongest = 64; ///< frames

  cv::Size frame_;
  bool decimate_first_;
  int level_;                      ///< of the L*a*b* image
  std::vector<cv::Mat> planes_[3]; ///< by octave
  cv::Mat ycrcb_, bgr_;
  std::vector<cv::Mat> lab_; ///< 8 bits, by octave
  cv::Mat center_, surround_, luma_, chroma_;
  std::vector<cv::Mat> cumulative_; ///< CV_64FC1, ring buffer
  std::size_t count_ = 0;
  cv::Mat tactile_;
};

} // namespace bench
