// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include "saliency_oracle.h"
#include "tolerance.h"

using oracle::Image;
using saliency::HistoryStart;
using saliency::TemporalPyramid;

namespace {

constexpr double kForever = 1e6;

/// The films of a test, frame by frame, and the mean over a window by its definition.
struct Film
{
  struct Display
  {
    double begin;
    double end;
    Image map;
  };
  HistoryStart start;
  std::vector<Display> displays;

  void push(const Image &map, double elapsed, double duration)
  {
    double begin = 0;
    if (!displays.empty()) {
      begin = displays.back().begin + elapsed;
      displays.back().end = begin;
    } else if (start == HistoryStart::filled) {
      displays.push_back({ -kForever, 0, map });
    }
    displays.push_back({ begin, begin + duration, map });
  }

  Image mean(double window) const
  {
    const double end = displays.back().end;
    Image sum(displays[0].map.width, displays[0].map.height);
    double length = 0;
    for (const auto &display : displays) {
      const double share = std::max(0.0, display.end - std::max(display.begin, end - window));
      length += share;
      for (std::size_t i = 0; i < sum.values.size(); ++i)
        sum.values[i] += share * display.map.values[i];
    }
    for (double &v : sum.values)
      v /= length;
    return sum;
  }
};

cv::Mat
mean_of(TemporalPyramid &pyramid, int window)
{
  std::vector<cv::Mat> maps;
  pyramid.means({ &window, 1 }, maps);
  return maps.at(0);
}

/// Pushes the same to both and compares all windows after each push.
void
compare(HistoryStart start, int count, const std::vector<double> &durations)
{
  TemporalPyramid pyramid(64, start);
  Film film{ start, {} };
  for (int i = 0; i < count; ++i) {
    const Image map = oracle::random_image(3, 2, 0, 100, static_cast<unsigned>(i));
    const auto at = [&](int k) {
      return durations[static_cast<std::size_t>(k) % durations.size()];
    };
    const double elapsed = i > 0 ? at(i - 1) : 0;
    pyramid.push(oracle::to_mat(map), elapsed, at(i));
    film.push(map, elapsed, at(i));
    constexpr std::array windows{ 1, 2, 3, 4, 8, 16, 32, 50, 64 };
    std::vector<cv::Mat> means;
    pyramid.means(windows, means);
    ck_assert_uint_eq(means.size(), windows.size());
    for (std::size_t w = 0; w < windows.size(); ++w) {
      const double e = oracle::difference(means[w], film.mean(windows[w]));
      fail_unless(e <= 1e-4, "frame %d, window %d: %g", i, windows[w], e);
    }
  }
}

} // namespace

GST_START_TEST(test_frames)
{
  for (const auto start : { HistoryStart::empty, HistoryStart::filled })
    compare(start, 200, { 1 });
}
GST_END_TEST;

GST_START_TEST(test_fractions)
{
  for (const auto start : { HistoryStart::empty, HistoryStart::filled })
    for (const double rate : { 24.0, 25.0, 30000 / 1001.0, 50.0, 60.0, 120.0 })
      compare(start, 300, { 30 / rate });
}
GST_END_TEST;

GST_START_TEST(test_variable_rate)
{
  for (const auto start : { HistoryStart::empty, HistoryStart::filled })
    compare(start, 300, { 1, 0.5, 2.3, 0.7, 1.001, 3, 0.2 });
}
GST_END_TEST;

GST_START_TEST(test_paper)
{
  // Level n averages the 2ⁿ latest maps, the current one included; map i is i everywhere.
  TemporalPyramid pyramid(64, HistoryStart::empty);
  for (int i = 0; i < 100; ++i) {
    pyramid.push(oracle::to_mat(Image(2, 2, i)), 1, 1);
    for (int n = 0; n <= 6; ++n) {
      const int first = std::max(0, i - (1 << n) + 1);
      fail_unless_near(mean_of(pyramid, 1 << n).at<float>(0), (first + i) / 2.0, 1e-5);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_same_film_at_any_rate)
{
  // A film whose picture changes each second, compared each half second: frame borders at all these
  // rates.
  const auto at_second = [](int second) {
    return oracle::random_image(4, 3, 0, 50, static_cast<unsigned>(second));
  };
  std::vector<cv::Mat> reference;
  for (const int rate : { 30, 24, 26, 48, 50, 60, 120 }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    std::vector<cv::Mat> means;
    for (int i = 0; i < 6 * rate; ++i) {
      pyramid.push(oracle::to_mat(at_second(i / rate)), 30.0 / rate, 30.0 / rate);
      if ((i + 1) * 2 % rate == 0)
        for (const int window : { 1, 8, 16, 64 })
          means.push_back(mean_of(pyramid, window));
    }
    if (reference.empty())
      reference = means;
    ck_assert_uint_eq(means.size(), reference.size());
    for (std::size_t i = 0; i < means.size(); ++i)
      fail_unless_at_most(cv::norm(means[i], reference[i], cv::NORM_INF), 1e-4);
  }
}
GST_END_TEST;

GST_START_TEST(test_start)
{
  for (const auto start : { HistoryStart::empty, HistoryStart::filled }) {
    TemporalPyramid pyramid(64, start);
    pyramid.push(oracle::to_mat(Image(2, 2, 5)), 0, 1);
    for (const int window : { 1, 8, 64 })
      fail_unless_near(mean_of(pyramid, window).at<float>(0), 5, 0);
    pyramid.push(oracle::to_mat(Image(2, 2, 21)), 1, 1);
    // Filled: seven frames of 5 and one of 21. Empty: one of each.
    fail_unless_near(mean_of(pyramid, 8).at<float>(0), start == HistoryStart::filled ? 7 : 13,
                     1e-5);
    pyramid.reset();
    pyramid.push(oracle::to_mat(Image(5, 1, 9)), 1, 1); // another size
    fail_unless_near(mean_of(pyramid, 64).at<float>(4), 9, 0);
  }
}
GST_END_TEST;

GST_START_TEST(test_what_does_not_change_is_exact)
{
  const Image map = oracle::random_image(6, 5, 0, 300, 7);
  for (const double duration : { 1.0, 30 / 24.0, 30 / 59.94, 30 / 1000.0 }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    for (int i = 0; i < 20000; ++i)
      pyramid.push(oracle::to_mat(map), duration, duration);
    for (const int window : { 1, 2, 8, 64 })
      fail_unless_near(oracle::difference(mean_of(pyramid, window), map), 0, 0);
  }
}
GST_END_TEST;

GST_START_TEST(test_long_run)
{
  // A million frames, nine hours at 30 fps: still the mean of the last ones, to float's precision.
  constexpr int kFrames = 1'000'000;
  for (const double duration : { 1.0, 30 / 29.97 }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    cv::Mat map(1, 2, CV_32FC1);
    const auto value = [](int i) {
      return 100 + 80 * std::sin(0.37 * i);
    };
    for (int i = 0; i < kFrames; ++i) {
      map.at<float>(0) = static_cast<float>(value(i));
      map.at<float>(1) = 255;
      pyramid.push(map, duration, duration);
    }
    for (const int window : { 1, 8, 64 }) {
      double sum = 0;
      for (int i = 0; i < 80; ++i) {
        const double begin = std::max(i * duration, 0.0);
        sum += std::max(0.0, std::min(begin + duration, 1.0 * window) - begin)
               * value(kFrames - 1 - i);
      }
      fail_unless_near(mean_of(pyramid, window).at<float>(0), sum / window, 2e-5);
      fail_unless_near(mean_of(pyramid, window).at<float>(1), 255, 0);
    }
    ck_assert_uint_le(pyramid.size(), 66);
  }
}
GST_END_TEST;

GST_START_TEST(test_memory_is_bounded)
{
  for (const double duration : { 1.0, 0.5, 0.25, 0.125, 0.1, 0.01, 1e-6, 1e-12 }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    std::size_t most = 0;
    for (int i = 0; i < 30000; ++i) {
      pyramid.push(oracle::to_mat(Image(1, 1, 3)), duration, duration);
      most = std::max(most, pyramid.size());
    }
    ck_assert_uint_le(most, duration >= 1 ? 66 : 8 * 64 + 3);
    fail_unless_near(mean_of(pyramid, 1).at<float>(0), 3, 1e-6);
    fail_unless_near(mean_of(pyramid, 64).at<float>(0), 3, 1e-6);
  }
}
GST_END_TEST;

GST_START_TEST(test_shared_entries)
{
  // At 3000 frames a second several share an entry. Inside one a window may begin up to 1/8 early
  // or late, no more: a step is placed to within that.
  TemporalPyramid pyramid(64, HistoryStart::filled);
  for (int i = 0; i < 20000; ++i)
    pyramid.push(oracle::to_mat(Image(1, 1, i < 19000 ? 0 : 80)), 0.01, 0.01);
  for (const int window : { 8, 16, 64 }) {
    const double on = std::min(1.0 * window, 1000 * 0.01);
    fail_unless_near(mean_of(pyramid, window).at<float>(0), 80 * on / window, 80 * 0.13 / window);
  }
}
GST_END_TEST;

GST_START_TEST(test_long_displays)
{
  // A slide, then another: however long they stand, the new one is seen against the old.
  for (const double duration : { 30.0, 1e4, 1e18, 1e300 }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    for (const double value : { 10.0, 10.0, 40.0 })
      pyramid.push(oracle::to_mat(Image(2, 2, value)), duration, duration);
    const double shown = TemporalPyramid::kLongestDisplay;
    fail_unless_near(mean_of(pyramid, 1).at<float>(0), 40, 1e-4);
    fail_unless_near(mean_of(pyramid, 8).at<float>(0), (40 * shown + 10 * (8 - shown)) / 8, 1e-4);
    // When it has been displaced itself it fills what its own display covers.
    pyramid.push(oracle::to_mat(Image(2, 2, 0)), duration, 1);
    fail_unless_near(mean_of(pyramid, 8).at<float>(0), 40.0 * 7 / 8, 1e-4);
    ck_assert_uint_le(pyramid.size(), 70);
  }
}
GST_END_TEST;

static Suite *
temporal_pyramid_suite(void)
{
  Suite *suite = suite_create("temporal_pyramid");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_frames);
  tcase_add_test(tc, test_fractions);
  tcase_add_test(tc, test_variable_rate);
  tcase_add_test(tc, test_paper);
  tcase_add_test(tc, test_same_film_at_any_rate);
  tcase_add_test(tc, test_start);
  tcase_add_test(tc, test_what_does_not_change_is_exact);
  tcase_add_test(tc, test_long_run);
  tcase_add_test(tc, test_memory_is_bounded);
  tcase_add_test(tc, test_shared_entries);
  tcase_add_test(tc, test_long_displays);
  return suite;
}

GST_CHECK_MAIN(temporal_pyramid);
