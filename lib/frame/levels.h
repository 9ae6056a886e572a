// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/types.hpp>

namespace saliency {

/// Size of pyramid level n: ⌈width / 2ⁿ⌉ × ⌈height / 2ⁿ⌉. Sample i of level n lies at pixel 2ⁿ·i of
/// level 0, because each reduction keeps the even samples. Resampling between levels has to respect
/// this: a resize that assumes half-pixel centers is off by up to (2ⁿ - 1)/2 pixels.
cv::Size level_size(cv::Size size, int level);

/// The level that is 1×1 (paper, Section 3: "until reaching the coarsest image of 1×1").
int coarsest_level(cv::Size size);

} // namespace saliency
