// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/surroundedness.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "support/check_tests.h"

using saliency::Surroundedness;

namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;

oracle::LabImage
plain(double l, double a = 0, double b = 0)
{
  return { oracle::Image(kWidth, kHeight, l), oracle::Image(kWidth, kHeight, a),
           oracle::Image(kWidth, kHeight, b) };
}

void
box(oracle::Image &image, int x, int y, int width, int height, double value)
{
  for (int j = y; j < y + height; ++j)
    for (int i = x; i < x + width; ++i)
      image(i, j) = value;
}

cv::Mat
map_of(const oracle::LabImage &lab, double step = 5, double exponent = 0.5)
{
  Surroundedness surroundedness(step, exponent);
  cv::Mat map;
  surroundedness(oracle::to_planes(lab), map);
  return map;
}

/// A region's area in percent of the picture.
double
percent(int pixels)
{
  return 100.0 * pixels / (kWidth * kHeight);
}

} // namespace

CHECK_TEST(test_box)
{
  // A box of 8×6 pixels, 30 above its surroundings, exceeds six thresholds 5 apart, 37.5…62.5. The
  // last one does not count, as no further one follows.
  for (const std::size_t channel : { 0U, 1U, 2U }) {
    for (const int sign : { -1, 1 }) {
      auto lab = plain(35, 35, 35);
      box(lab[channel], 10, 12, 8, 6, 35 + sign * 30);
      const cv::Mat map = map_of(lab);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const bool inside = x >= 10 && x < 18 && y >= 12 && y < 18;
          fail_unless_near(map.at<float>(y, x), inside ? 25 / std::sqrt(percent(48)) : 0, 1e-3);
          fail_unless(inside || map.at<float>(y, x) == 0);
        }
    }
  }
}

CHECK_TEST(test_channels_add_up)
{
  auto lab = plain(35, 0, 0);
  box(lab[0], 10, 12, 8, 6, 45);
  box(lab[1], 10, 12, 8, 6, -20);
  box(lab[2], 10, 12, 8, 6, 15);
  fail_unless_near(map_of(lab, 5, 0).at<float>(14, 12), 5 + 15 + 10, 1e-3);
}

CHECK_TEST(test_border)
{
  // A box that touches the border with a single sample is background. One sample further in it is
  // not.
  for (const auto &[x, y, surrounded] : { std::tuple{ 0, 12, false },
                                          { 1, 12, true },
                                          { kWidth - 8, 12, false },
                                          { kWidth - 9, 12, true },
                                          { 10, 0, false },
                                          { 10, 1, true },
                                          { 10, kHeight - 6, false },
                                          { 10, kHeight - 7, true } }) {
    auto lab = plain(35);
    box(lab[0], x, y, 8, 6, 65);
    fail_unless((cv::countNonZero(map_of(lab)) > 0) == surrounded, "%d, %d", x, y);
  }
  // A line one sample wide connects the box to the border, a diagonal one does not.
  auto tied = plain(35);
  box(tied[0], 10, 12, 8, 6, 65);
  box(tied[0], 18, 14, kWidth - 18, 1, 65);
  ck_assert_int_eq(cv::countNonZero(map_of(tied)), 0);
  auto diagonal = plain(35);
  box(diagonal[0], 10, 12, 8, 6, 65);
  for (int i = 18; i < kHeight; ++i)
    diagonal[0](i, i) = 65;
  fail_unless(map_of(diagonal).at<float>(14, 12) > 0);
}

CHECK_TEST(test_nested)
{
  // The background encloses a ring, and the ring its hole. All 5 thresholds separate the two: the
  // hole has the background's color.
  auto lab = plain(35);
  box(lab[0], 10, 8, 12, 10, 60);
  box(lab[0], 14, 11, 4, 4, 35);
  const cv::Mat map = map_of(lab);
  fail_unless_near(map.at<float>(9, 11), 20 / std::sqrt(percent(120 - 16)), 1e-3);
  fail_unless_near(map.at<float>(12, 15), 20 / std::sqrt(percent(16)), 1e-3);
  // A peak on a plateau: 3 thresholds enclose both, 2 more only the peak. Of those, 1 counts.
  box(lab[0], 10, 8, 12, 10, 50);
  box(lab[0], 14, 11, 4, 4, 60);
  const cv::Mat peak = map_of(lab);
  fail_unless_near(peak.at<float>(9, 11), 15 / std::sqrt(percent(120)), 1e-3);
  fail_unless_near(peak.at<float>(12, 15),
                   15 / std::sqrt(percent(120)) + 5 / std::sqrt(percent(16)), 1e-3);
}

CHECK_TEST(test_resolution)
{
  // Areas are shares of the picture: a map of twice the resolution has the same values.
  auto lab = plain(35);
  box(lab[0], 10, 12, 8, 6, 65);
  oracle::LabImage fine{ oracle::Image(2 * kWidth, 2 * kHeight, 35),
                         oracle::Image(2 * kWidth, 2 * kHeight),
                         oracle::Image(2 * kWidth, 2 * kHeight) };
  box(fine[0], 20, 24, 16, 12, 65);
  fail_unless_near(map_of(fine).at<float>(26, 26), map_of(lab).at<float>(14, 12), 1e-3);
}

CHECK_TEST(test_no_figure)
{
  // A flat picture, a ramp, stripes, and noise that crosses only one threshold.
  ck_assert_int_eq(cv::countNonZero(map_of(plain(53.6, 1e-5, -2e-5))), 0);
  auto ramp = plain(0);
  auto stripes = plain(0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      ramp[0](x, y) = 2 * x + 0.5 * y;
      stripes[1](x, y) = y % 4 < 2 ? -40 : 40;
    }
  ck_assert_int_eq(cv::countNonZero(map_of(ramp)), 0);
  ck_assert_int_eq(cv::countNonZero(map_of(stripes)), 0);
  const oracle::LabImage noise{ oracle::random_image(kWidth, kHeight, 42.6, 52.4, 1),
                                oracle::random_image(kWidth, kHeight, -2.4, 7.4, 2),
                                oracle::random_image(kWidth, kHeight, 7.6, 12.4, 3) };
  ck_assert_int_eq(cv::countNonZero(map_of(noise)), 0);
}

CHECK_TEST(test_brute_force)
{
  // One object for pictures of changing size: nothing of an earlier one may remain. Smooth
  // structure and noise, with values within and beyond the range of colors.
  Surroundedness surroundedness(7, 0.75);
  unsigned seed = 1;
  for (const auto &[width, height] : { std::pair{ 1, 1 },
                                       { 1, 9 },
                                       { 9, 1 },
                                       { 2, 2 },
                                       { 3, 3 },
                                       { 31, 17 },
                                       { 17, 31 },
                                       { 31, 17 },
                                       { 50, 40 } })
    for (const double amplitude : { 20.0, 100.0, 300.0 }) {
      oracle::LabImage lab;
      for (auto &channel : lab) {
        channel = oracle::random_image(width, height, -0.3 * amplitude, 0.3 * amplitude, ++seed);
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x)
            channel(x, y) += amplitude * std::sin(0.3 * x + seed) * std::cos(0.4 * y);
        // Values beyond ±128, which no color has, are clipped.
        for (double &v : channel.values)
          v = static_cast<double>(static_cast<float>(std::clamp(v, -128.0, 128.0)));
      }
      cv::Mat map;
      surroundedness(oracle::to_planes(lab), map);
      const auto expected = oracle::surroundedness(lab, 7, 0.75);
      fail_unless_at_most(oracle::difference(map, expected), 1e-5 * expected.maximum() + 1e-9);
    }
}

CHECK_MAIN(surroundedness)
