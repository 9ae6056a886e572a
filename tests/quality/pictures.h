// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>

namespace quality {

/// A picture with the statistics of natural ones, CV_8UC3 BGR: "dead leaves" (Lee, Mumford, Huang
/// 2001), discs that cover one another, their radii distributed as r⁻³ from 1/160 to 1/10 of the
/// width, each of one color with a slope of lightness; colors spread like those of photographs,
/// lightness widely and chroma little. The same for the same seed, everywhere.
cv::Mat dead_leaves(cv::Size size, std::uint64_t seed);

} // namespace quality
