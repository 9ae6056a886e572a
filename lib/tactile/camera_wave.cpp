// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/camera_wave.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactile {

namespace {

constexpr double kLongestGap = 1;  ///< s
constexpr double kSmoothing = 0.5; ///< time constant of the speed and of the return, s

} // namespace

void
CameraWave::follow(const CameraWay &way, Time time, TactileMap &map)
{
  const double passed = last_time_ ? std::chrono::duration<double>(time - *last_time_).count() : 0;
  if (passed < 0 || passed > kLongestGap)
    reset();
  const bool begins = !last_time_;
  last_time_ = time;
  if (begins || passed == 0)
    return;

  const double keeps = std::exp(-passed / kSmoothing);
  const auto smooth = [&](double &mean, double value) {
    mean = value + keeps * (mean - value);
  };
  smooth(speed_.right, way.right / passed);
  smooth(speed_.down, way.down / passed);
  smooth(speed_.ahead, way.ahead / passed / 2); // of the picture's edge
  const double speed = std::hypot(speed_.right, speed_.down, speed_.ahead);
  cycles_ += passed * std::min(speed, kFastest) / kFastest;
  cycles_ -= std::floor(cycles_);
  if (std::ranges::any_of(map.levels, [](float level) { return level > 0; })) {
    ease_ = 0;
    return;
  }
  smooth(ease_, 1);
  const double share = std::min(1.0, (speed - kSlowest) / (kFastest - kSlowest));
  if (share <= 0)
    return;
  for (int r = 0; r < map.rows; ++r)
    for (int c = 0; c < map.columns; ++c) {
      const double x = (c + 0.5) / map.columns - 0.5;
      const double y = (r + 0.5) / map.rows - 0.5;
      const double along
          = (speed_.right * x + speed_.down * y + speed_.ahead * std::abs(x)) / speed;
      const double wave = (1 + std::cos(2 * std::numbers::pi * (along - cycles_))) / 2;
      map.levels[static_cast<std::size_t>(r * map.columns + c)]
          = static_cast<float>(kMost * share * ease_ * wave);
    }
}

} // namespace tactile
