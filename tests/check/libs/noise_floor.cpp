// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Activity that goes on all the time is no event (NoiseFloor).
#include "saliency/events/noise_floor.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "support/check_tests.h"

using oracle::Image;
using saliency::NoiseFloor;

CHECK_TEST(test_constant_activity)
{
  // Smoothed, it rises as 1 − e^(−t/4), so the least of a stretch is its first, and the least of
  // the last seven stretches is the oldest's.
  constexpr double kValue = 0.5;
  for (const double step : { 0.25, 0.5, 1.25 }) {
    NoiseFloor floor;
    for (int i = 0; i * step < 400; ++i) {
      cv::Mat map = oracle::to_mat(Image(10, 6, kValue));
      floor.subtract(map, step);
      const int stretch = static_cast<int>(i * step / 30);
      const double first = std::max(0, stretch - 6) * 30 + step;
      const double lowered = 7 * kValue * (1 - std::exp(-first / 4));
      const double expected = stretch < 4 ? kValue : std::max(0.0, kValue - lowered);
      fail_unless_at_most(oracle::difference(map, Image(10, 6, expected)), 1e-4);
    }
  }
}

CHECK_TEST(test_pause)
{
  // Activity that paused in one of the last seven stretches of 30 frames is lowered only by what
  // smoothing leaves of it. The pause ends in the stretch from 240 to 270, which counts until 450.
  NoiseFloor floor;
  for (int i = 0; i < 520; ++i) {
    const bool pauses = i >= 200 && i < 250;
    cv::Mat map = oracle::to_mat(Image(10, 6, pauses ? 0.0 : 3.0));
    floor.subtract(map, 1);
    if (i >= 180 && i < 200)
      fail_unless_near(map.at<float>(0), 0, 0);
    if (i >= 250 && i < 450)
      fail_unless_near(map.at<float>(0), 3, 7 * 3 * std::exp(-50 / 4.0) + 1e-4);
    if (i >= 450)
      fail_unless_near(map.at<float>(0), 0, 0);
  }
}

CHECK_TEST(test_strong_activity)
{
  // An event of 40 above constant activity of that strength.
  for (const auto &[activity, lowered] : { std::pair{ 0.5, 3.5 },
                                           { 0.9, 6.3 },
                                           { 3.0, 14.0 },
                                           { 7.5, 7.0 },
                                           { 7.75, 3.5 },
                                           { 9.0, 0.0 } }) {
    NoiseFloor floor;
    for (int i = 0; i < 300; ++i) {
      cv::Mat map = oracle::to_mat(Image(10, 6, activity));
      floor.subtract(map, 1);
    }
    cv::Mat map = oracle::to_mat(Image(10, 6, activity));
    map.at<float>(0) = 40;
    floor.subtract(map, 1);
    fail_unless_near(map.at<float>(0), 40 - lowered, 1e-3);
    fail_unless_near(map.at<float>(9), std::max(0.0, activity - lowered), 1e-3);
  }
}

CHECK_TEST(test_reach_and_reset)
{
  // Activity at (8, 6) lowers an event up to 5 of 20 samples away.
  NoiseFloor floor;
  const auto lowered = [&floor](double elsewhere) {
    Image image(20, 12, elsewhere);
    image(8, 6) = 3;
    cv::Mat map = oracle::to_mat(image);
    floor.subtract(map, 1);
    return map;
  };
  for (int i = 0; i < 300; ++i)
    lowered(0);
  const cv::Mat map = lowered(3);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 20; ++x)
      fail_unless_near(map.at<float>(y, x), std::max(std::abs(x - 8), std::abs(y - 6)) <= 5 ? 0 : 3,
                       1e-3);
  floor.reset();
  for (int i = 0; i < 120; ++i)
    fail_unless_near(lowered(3).at<float>(6, 8), 3, 0);
  fail_unless(lowered(3).at<float>(6, 8) < 3);
}

CHECK_MAIN(noise_floor)
