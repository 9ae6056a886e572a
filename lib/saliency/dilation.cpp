// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/dilation.h"

#include <algorithm>

namespace saliency {

void
dilate(const cv::Mat &map, int radius, cv::Mat &along_rows, cv::Mat &dilated)
{
  const auto raise = [](const float *by, int count, float *values) {
    for (int x = 0; x < count; ++x)
      values[x] = std::max(values[x], by[x]);
  };
  map.copyTo(along_rows);
  for (int y = 0; y < map.rows; ++y)
    for (int by = 1; by <= std::min(radius, map.cols - 1); ++by) {
      raise(map.ptr<float>(y), map.cols - by, along_rows.ptr<float>(y) + by);
      raise(map.ptr<float>(y) + by, map.cols - by, along_rows.ptr<float>(y));
    }
  along_rows.copyTo(dilated);
  for (int y = 0; y < map.rows; ++y)
    for (int from = std::max(0, y - radius); from <= std::min(map.rows - 1, y + radius); ++from)
      raise(along_rows.ptr<float>(from), map.cols, dilated.ptr<float>(y));
}

} // namespace saliency
