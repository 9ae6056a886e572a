// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>

using oracle::Image;
using saliency::TemporalPyramid;

namespace {

cv::Mat
mean_of(const TemporalPyramid &pyramid, int window)
{
  std::vector<cv::Mat> maps;
  pyramid.means({ &window, 1 }, maps);
  return maps.at(0);
}

} // namespace

GST_START_TEST(test_paper)
{
  // Level n averages the 2ⁿ latest maps, including the current one. Map i has the value i
  // everywhere.
  TemporalPyramid pyramid(64);
  for (int i = 0; i < 200; ++i) {
    pyramid.push(oracle::to_mat(Image(2, 2, i)));
    for (int n = 0; n <= 6; ++n) {
      const int first = std::max(0, i - (1 << n) + 1);
      fail_unless_near(mean_of(pyramid, 1 << n).at<float>(0), (first + i) / 2.0, 1e-5);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_definition)
{
  TemporalPyramid pyramid(64);
  std::vector<Image> maps;
  for (unsigned i = 0; i < 200; ++i) {
    maps.push_back(oracle::random_image(3, 2, 0, 100, i));
    pyramid.push(oracle::to_mat(maps.back()));
    constexpr std::array windows{ 1, 2, 3, 4, 8, 16, 32, 50, 64 };
    std::vector<cv::Mat> means;
    pyramid.means(windows, means);
    ck_assert_uint_eq(means.size(), windows.size());
    for (std::size_t w = 0; w < windows.size(); ++w) {
      const std::size_t count = std::min(maps.size(), static_cast<std::size_t>(windows[w]));
      Image mean(3, 2);
      for (std::size_t k = maps.size() - count; k < maps.size(); ++k)
        for (std::size_t p = 0; p < mean.values.size(); ++p)
          mean.values[p] += maps[k].values[p] / static_cast<double>(count);
      fail_unless_at_most(oracle::difference(means[w], mean), 1e-4);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_reset)
{
  TemporalPyramid pyramid(64);
  for (int i = 0; i < 70; ++i)
    pyramid.push(oracle::to_mat(Image(2, 2, 5)));
  pyramid.reset();
  pyramid.push(oracle::to_mat(Image(5, 1, 9))); // another size
  fail_unless_near(mean_of(pyramid, 64).at<float>(4), 9, 0);
  pyramid.push(oracle::to_mat(Image(5, 1, 21)));
  fail_unless_near(mean_of(pyramid, 8).at<float>(0), 15, 1e-5);
}
GST_END_TEST;

GST_START_TEST(test_long_run)
{
  // After a million frames, nine hours at 30 fps, means are exact to float's precision.
  constexpr int kFrames = 1'000'000;
  TemporalPyramid pyramid(64);
  cv::Mat map(1, 2, CV_32FC1);
  const auto value = [](int i) {
    return 100 + 80 * std::sin(0.37 * i);
  };
  for (int i = 0; i < kFrames; ++i) {
    map.at<float>(0) = static_cast<float>(value(i));
    map.at<float>(1) = 255;
    pyramid.push(map);
  }
  for (const int window : { 1, 8, 64 }) {
    double sum = 0;
    for (int i = 0; i < window; ++i)
      sum += value(kFrames - 1 - i);
    fail_unless_near(mean_of(pyramid, window).at<float>(0), sum / window, 2e-5);
    fail_unless_near(mean_of(pyramid, window).at<float>(1), 255, 0);
  }
}
GST_END_TEST;

static Suite *
temporal_pyramid_suite(void)
{
  Suite *suite = suite_create("temporal pyramid");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_paper);
  tcase_add_test(tc, test_definition);
  tcase_add_test(tc, test_reset);
  tcase_add_test(tc, test_long_run);
  return suite;
}

GST_CHECK_MAIN(temporal_pyramid);
