// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace saliency {

/// The means of a frame's components over blocks of 2ⁿ × 2ⁿ pixels, in codes of 8 bits: a cheap
/// look at a frame, which converts nothing. Of a block, at most eight rows are read.
class BlockMeans
{
public:
  /// The means at `level` n, at most 8; valid until the next call. Requires an empty
  /// fault_of(frame). Allocates only when the geometry changes.
  const std::array<cv::Mat1f, 3> &operator()(const FrameView &frame, int level);

private:
  void add(const FrameView &frame, const Component &component, int level, cv::Mat1f &means);

  std::vector<std::uint16_t> sums_; ///< of the columns of a row of blocks
  std::array<cv::Mat1f, 3> means_;
};

} // namespace saliency
