// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace quality {

/// The spatiotemporal saliency of HapticLens (John & Seifi, CHI '26), which adapts the paper to one
/// actuator: luma instead of L*a*b*, absolute temporal differences at full resolution, each map
/// stretched to [0, 1], no threshold. Written from the description of class SpatiotemporalSaliency
/// in src/saliency.py of github.com/loveyw02/HapticLens_CodeReview at commit 7a38c3c.
///
/// Frames enter a window as they come (use_padded_buffer=False there), since padding by reflection
/// needs frames of the future. Averages are exact running sums, so its speed is not HapticLens's.
class HapticLens
{
public:
  /// The map of a film's next frame, CV_8UC3 B'G'R', all of one size. CV_32FC1 in [0, 1] of that
  /// size; 0 in the first seven frames. Valid until the next call.
  const cv::Mat &film_map(const cv::Mat &frame);

  /// The spatial map of a picture, likewise. It does not count as a frame.
  const cv::Mat &picture_map(const cv::Mat &picture);

  /// Forgets all frames.
  void reset();

private:
  static constexpr std::size_t kWindows = 7; ///< of 1, 2, 4, …, 64 frames
  static constexpr std::size_t kLongest = std::size_t{ 1 } << (kWindows - 1);

  void remember(const cv::Mat &luma);
  void find_spatial(const cv::Mat &luma);
  bool find_temporal();

  std::vector<cv::Mat> frames_; ///< CV_16UC1, the latest kLongest; oldest at count_ % kLongest
  std::size_t count_ = 0;
  std::array<cv::Mat, kWindows> sums_; ///< CV_32SC1, of the latest 2ⁿ frames
  std::array<cv::Mat, kWindows> means_;
  cv::Mat spatial_;
  cv::Mat temporal_;
  cv::Mat map_;
};

} // namespace quality
