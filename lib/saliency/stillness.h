// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/block_means.h"

#include <array>
#include <vector>

namespace saliency {

/// Whether a frame shows the same as an earlier one but for noise: a cheap test before an analysis,
/// which finds nothing in such a frame.
///
/// The means of blocks are compared, in units of about ΔE. Half of the difference that Unexplained
/// takes for noise is allowed, and beyond it `beyond` on average over 4 × 4 blocks.
class Stillness
{
public:
  /// Whether `frame` shows the same as the reference. If not, or without a reference, `frame` is
  /// the new one. `level`: of the blocks; `beyond`: in ΔE.
  bool operator()(const FrameView &frame, int level, double beyond);

  /// Allocates all that frames like this one need. There is no reference then.
  void prepare(const FrameView &frame, int level);

  /// `frame` is the reference.
  void keep(const FrameView &frame, int level);

  bool known() const
  {
    return known_;
  }

  /// Drops the reference.
  void reset()
  {
    known_ = false;
  }

private:
  bool same(const cv::Mat1f &now, const cv::Mat1f &before, float beyond);

  BlockMeans means_;
  std::array<cv::Mat1f, 3> reference_;
  bool known_ = false;
  std::vector<float> differences_;
  std::vector<float> beyond_; ///< noise, of a row of groups of blocks
};

} // namespace saliency
