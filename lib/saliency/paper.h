// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/thread_pool.h"
#include "saliency/contrast.h"
#include "saliency/pyramid.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>

namespace saliency {

/// Section 3 of the paper: from the L*a*b* pyramid of a frame to its spatial saliency S and, with
/// the frames before it, the spatiotemporal saliency ST. `profile=paper`.
///
/// The sums of S are stored in double precision, one a frame, as in a summed-area table: a mean is
/// one subtraction, exact to float precision for years of film. Memory: 65 sums of 8 bytes per
/// sample. Nothing is allocated once the history is full.
class Paper
{
public:
  static constexpr int kSaliencyLevel = 2;                 ///< of S and ST
  static constexpr std::array<int, 3> kCenters{ 2, 3, 4 }; ///< c of C(c, s)
  static constexpr std::array<int, 3> kTemporalCenters{ 0, 1, 2 };
  static constexpr std::array<int, 2> kDeltas{ 3, 4 };       ///< δ in s = c + δ, in both pyramids
  static constexpr std::size_t kTemporalLevels = 7;          ///< 0 to 2 + 4
  static constexpr int kFrames = 1 << (kTemporalLevels - 1); ///< of the longest mean

  /// S, "contrast maps are linearly combined to yield [a] single … saliency map": Σ N(C(c, s)).
  /// `lab` has levels 2 to 8 of a frame of the given size, as far as there are such levels; finer
  /// levels stand for missing coarser ones. CV_32FC1 of level 2's size, ≥ 0, valid until the next
  /// call.
  const cv::Mat &spatial(const Pyramid &lab, cv::Size frame, const Team &team = {});

  /// ST, N(Σ |T_c − T_s|), with `map`, S of the next frame (CV_32FC1, finite; all maps between two
  /// resets have one size). The result is valid until the next call.
  const cv::Mat &spatiotemporal(const cv::Mat &map, const Team &team = {});

  /// The temporal pyramid, "a level-n image averages the spatial saliency maps of 2ⁿ previous
  /// frames including the current frame", of fewer at the beginning: T_n, as of the last
  /// spatiotemporal().
  const cv::Mat &temporal_level(std::size_t n) const
  {
    return means_.at(n);
  }

  /// Drops the history.
  void reset()
  {
    count_ = 0;
  }

private:
  cv::Mat &sum(std::size_t count)
  {
    return sums_[count % sums_.size()];
  }

  Contrast contrast_{ 1 }; // CIE 1976 ΔE
  std::array<cv::Mat, kCenters.size()> contrast_maps_;
  cv::Mat upsampled_;
  cv::Mat spatial_;

  std::array<cv::Mat, kFrames + 1> sums_; ///< CV_64FC1, a ring: of the first `count` maps
  std::size_t count_ = 0;                 ///< of maps since the reset
  std::array<cv::Mat, kTemporalLevels> means_;
  cv::Mat spatiotemporal_;
};

} // namespace saliency
