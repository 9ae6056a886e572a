// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/thread_pool.h"

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace saliency {

/// The temporal pyramid (paper, Section 3: "a level-n image averages the spatial saliency maps of
/// 2ⁿ previous frames including the current frame"), for windows of any length.
///
/// At each push the sum of the maps is stored in double precision, as in a summed-area table. A
/// window's mean is one subtraction. The sum only grows, but means stay exact to float precision
/// for years of film. Before the first push there is nothing: a mean is of what exists.
///
/// Memory: longest + 1 sums of 8 bytes per sample. Nothing is allocated once the history is full.
class TemporalPyramid
{
public:
  /// `longest`: the longest window passed to means(), in frames, ≥ 1.
  explicit TemporalPyramid(int longest);

  /// Drops the history.
  void reset();

  /// Adds the next map (CV_32FC1, finite). All maps between two resets have one size.
  void push(const cv::Mat &map);

  /// Means over the last `windows` frames, each > 0, into as many `maps` (CV_32FC1). Requires at
  /// least one push.
  void means(std::span<const int> windows, std::vector<cv::Mat> &maps, const Team &team = {}) const;

private:
  /// The sum of the first `count` maps.
  const cv::Mat &sum(std::size_t count) const
  {
    return sums_[count % sums_.size()];
  }

  std::vector<cv::Mat> sums_; ///< CV_64FC1, a ring
  std::size_t count_ = 0;     ///< of maps since the reset
};

} // namespace saliency
