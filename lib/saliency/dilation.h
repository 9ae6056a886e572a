// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

namespace saliency {

/// Dilation of a CV_32FC1 map of values ≥ 0 with a square of side 2 · radius + 1. `along_rows` is
/// scratch space: dilated along rows only.
void dilate(const cv::Mat &map, int radius, cv::Mat &along_rows, cv::Mat &dilated);

} // namespace saliency
