// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <deque>
#include <vector>

namespace bench {

/// A literal implementation of the paper's Section 3 with OpenCV in float: the baseline of the
/// benchmark. Where the paper leaves a choice, it takes the usual or the cheaper one.
class LiteralPaper
{
public:
  /// `i420`: CV_8UC1, 3/2 the height. Returns a 3 × 3 map in [0, 1], CV_32FC1.
  const cv::Mat &frame(const cv::Mat &i420);

private:
  cv::Mat bgr_, bgr_float_;
  std::vector<cv::Mat> pyramid_; ///< L*a*b*, down to 1 × 1
  std::deque<cv::Mat> history_;  ///< spatial maps, newest first
  cv::Mat tactile_;
};

} // namespace bench
