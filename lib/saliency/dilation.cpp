// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/dilation.h"

#include "saliency/rows.h"

#include <algorithm>
#include <cstddef>

namespace saliency {

namespace {

/// The greatest of the 2 · radius + 1 values around each of n.
void
dilate_row(const float *in, int n, int radius, float *out)
{
  float left = 0;
  float right = 0;
  radius = std::min(radius, n - 1);
  for (int i = 0; i < radius; ++i) {
    left = std::max(left, in[i]);
    right = std::max(right, in[n - 1 - i]);
  }
  // Near the ends the window is cut.
  for (int i = 0; i <= radius; ++i) {
    if (i + radius < n)
      left = std::max(left, in[i + radius]);
    if (n - 1 - i - radius >= 0)
      right = std::max(right, in[n - 1 - i - radius]);
    out[i] = left;
    out[n - 1 - i] = right;
  }
  if (n > 2 * radius)
    rows::greatest(in, 1, 2 * radius + 1, static_cast<std::size_t>(n - 2 * radius), out + radius);
}

} // namespace

void
dilate(const cv::Mat &map, int radius, cv::Mat &along_rows, cv::Mat &dilated)
{
  along_rows.create(map.size(), CV_32FC1);
  dilated.create(map.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y)
    dilate_row(map.ptr<float>(y), map.cols, radius, along_rows.ptr<float>(y));
  for (int y = 0; y < map.rows; ++y) {
    const int first = std::max(0, y - radius);
    const int last = std::min(map.rows - 1, y + radius);
    rows::greatest(along_rows.ptr<float>(first), static_cast<std::ptrdiff_t>(along_rows.step1()),
                   last - first + 1, static_cast<std::size_t>(map.cols), dilated.ptr<float>(y));
  }
}

} // namespace saliency
