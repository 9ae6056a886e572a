// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/activity.h"

#include "frame/levels.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace people {

void
Activity::add(const cv::Mat &lightness, double elapsed, bool camera_moves)
{
  constexpr double kWindow = 0.25; // time constant in seconds

  if (camera_moves || last_.size() != lightness.size() || elapsed <= 0) {
    change_.create(lightness.size());
    change_.setTo(0);
    drift_.create(lightness.size());
    drift_.setTo(0);
    lightness.copyTo(last_);
    return;
  }
  const auto per_frame = static_cast<float>(1 / (30 * elapsed));
  const auto share = static_cast<float>(1 - std::exp(-elapsed / kWindow));
  const auto *now = lightness.ptr<float>();
  auto *before = last_.ptr<float>();
  auto *change = change_.ptr<float>();
  auto *drift = drift_.ptr<float>();
  const auto total = static_cast<std::ptrdiff_t>(lightness.total());
  for (std::ptrdiff_t i = 0; i < total; ++i) {
    const float by = (now[i] - before[i]) * per_frame;
    change[i] += share * (std::abs(by) - change[i]);
    drift[i] += share * (by - drift[i]);
    before[i] = now[i];
  }
}

const cv::Mat1f &
Activity::beyond_noise(cv::Size map)
{
  int octaves = 0;
  while (saliency::level_size(change_.size(), octaves).width > map.width)
    octaves++;
  // Sample i of the map is centered on sample 2ⁿ·i.
  const int side = 1 << octaves;
  const cv::Rect all({}, change_.size());
  beyond_.create(map);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const cv::Rect block = cv::Rect(x * side - side / 2, y * side - side / 2, side, side) & all;
      float sum = 0;
      for (int row = block.y; row < block.br().y; ++row)
        for (int column = block.x; column < block.br().x; ++column)
          sum += change_(row, column) - std::abs(drift_(row, column));
      beyond_(y, x) = sum / static_cast<float>(std::max(1, block.area()));
    }
  sorted_.assign(beyond_.begin(), beyond_.end());
  const auto quartile = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() * 3 / 4);
  std::ranges::nth_element(sorted_, quartile);
  for (float &value : beyond_)
    value = std::max(0.0F, value - 2 * *quartile);
  return beyond_;
}

} // namespace people
