// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>

namespace quality {

/// A picture with the statistics of natural ones, CV_8UC3 BGR: "dead leaves" (Lee, Mumford, Huang
/// 2001), overlapping discs with radii distributed as r⁻³ from 1/160 to 1/10 of the width. Each has
/// one color with a gradient of lightness. As in photographs, lightness varies much and chroma
/// little. The same seed gives the same picture on every machine.
cv::Mat dead_leaves(cv::Size size, std::uint64_t seed);

} // namespace quality
