// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/normalization.h"

#include <opencv2/core.hpp>

#include <algorithm>

namespace saliency {

namespace {

/// Whether row[x] is more than `rise` above its 8 neighbors.
bool
is_local_maximum(const float *above, const float *row, const float *below, int x, float rise)
{
  const float v = row[x] - rise;
  return v > row[x - 1] && v > row[x + 1] && v > above[x - 1] && v > above[x] && v > above[x + 1]
         && v > below[x - 1] && v > below[x] && v > below[x + 1];
}

/// m̄ of a map that spans [0, 1].
double
mean_of_other_maxima(const cv::Mat &map, float rise)
{
  double sum = 0;
  int count = 0;
  bool global_found = false;
  for (int y = 1; y + 1 < map.rows; ++y) {
    const auto *above = map.ptr<float>(y - 1);
    const auto *row = map.ptr<float>(y);
    const auto *below = map.ptr<float>(y + 1);
    for (int x = 1; x + 1 < map.cols; ++x) {
      if (!is_local_maximum(above, row, below, x, rise))
        continue;
      if (row[x] >= 1 && !global_found) {
        global_found = true;
        continue;
      }
      sum += row[x];
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

} // namespace

void
normalize_itti(cv::Mat &map)
{
  double low = 0;
  double high = 0;
  cv::minMaxLoc(map, &low, &high);
  const auto floor = static_cast<float>(low);
  const auto span = static_cast<float>(high) - floor;
  if (span <= kRounding) {
    for (int y = 0; y < map.rows; ++y)
      std::fill_n(map.ptr<float>(y), map.cols, 0.0F);
    return;
  }
  // Subtract and divide rather than scale and offset: the maximum becomes exactly 1, which
  // mean_of_other_maxima() relies on.
  for (int y = 0; y < map.rows; ++y) {
    auto *row = map.ptr<float>(y);
    for (int x = 0; x < map.cols; ++x)
      row[x] = (row[x] - floor) / span;
  }
  const double others = mean_of_other_maxima(map, kRounding / span);
  map *= (1 - others) * (1 - others);
}

} // namespace saliency
