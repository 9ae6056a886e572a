// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

using oracle::Image;
using saliency::HistoryStart;
using saliency::Similarity;
using saliency::TemporalPyramid;

namespace {

constexpr double kForever = 1e6;

/// A film, and the mean over a window by its definition.
struct ExactHistory
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

/// Pushes the same maps to both and compares all windows after each push.
void
compare(HistoryStart start, int count, const std::vector<double> &durations)
{
  TemporalPyramid pyramid(64, start);
  ExactHistory film{ start, {} };
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

/// A film of a moving camera, and the means over windows as TemporalPyramid defines them.
struct MovedFilm
{
  struct Display
  {
    double begin;
    Image map;
    Similarity pose;
  };
  std::vector<Display> displays; ///< each ends where the next begins
  double end = 0;                ///< of the last

  void push(const Image &map, double elapsed, double duration, const Similarity &pose)
  {
    if (displays.empty())
      displays.push_back({ -kForever, map, pose });
    const double begin = displays.size() == 1 ? 0 : displays.back().begin + elapsed;
    displays.push_back({ begin, map, pose });
    end = begin + duration;
  }

  /// The display at a time. A moment between two belongs to the earlier one.
  std::size_t before(double time) const
  {
    std::size_t i = displays.size() - 1;
    while (i > 0 && displays[i].begin >= time - 1e-9)
      --i;
    return i;
  }

  /// The mean of what was displayed in an interval.
  Image stretch(double from, double to) const
  {
    Image sum(displays[0].map.width, displays[0].map.height);
    for (std::size_t i = 0; i < displays.size(); ++i) {
      const double until = i + 1 < displays.size() ? displays[i + 1].begin : end;
      const double share = std::min(to, until) - std::max(from, displays[i].begin);
      for (std::size_t p = 0; share > 0 && p < sum.values.size(); ++p)
        sum.values[p] += share / (to - from) * displays[i].map.values[p];
    }
    return sum;
  }

  /// `windows` is in ascending order. Where a window begins, so does a stretch.
  std::vector<Image> means(std::span<const int> windows) const
  {
    const Display &now = displays.back();
    Image sum(now.map.width, now.map.height);
    std::vector<Image> result;
    double to = end;
    for (const int window : windows) {
      const double start = end - window;
      while (to > start + 1e-9) {
        const double from = std::max(start, displays[before(to - (end - to) / 4)].begin);
        const Similarity &then = displays[before((from + to) / 2)].pose;
        const Image map = stretch(from, to);
        for (int y = 0; y < sum.height; ++y)
          for (int x = 0; x < sum.width; ++x) {
            // Where the point (x, y) of the current map was in that stretch's map.
            const double px = now.pose.x(x, y) - then.tx;
            const double py = now.pose.y(x, y) - then.ty;
            const double norm = then.a * then.a + then.b * then.b;
            const double at_x = (then.a * px + then.b * py) / norm;
            const double at_y = (then.a * py - then.b * px) / norm;
            const bool seen
                = at_x >= 1 && at_y >= 1 && at_x < sum.width - 2 && at_y < sum.height - 2;
            const double value = then == now.pose ? map(x, y)
                                 : seen           ? oracle::bilinear(map, at_x, at_y)
                                                  : now.map(x, y);
            sum(x, y) += (to - from) * value;
          }
        to = from;
      }
      Image mean = sum;
      for (double &v : mean.values)
        v /= window;
      result.push_back(mean);
    }
    return result;
  }
};

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

GST_START_TEST(test_poses)
{
  // A camera that shakes, pans, zooms, rolls and sometimes rests, at 30, 24, about 25, 60 and a
  // variable number of frames a second. (At exactly 25 fps rounding would decide whether the 9th
  // map back is a quarter of its age long.)
  const std::vector<std::vector<double>> rates{ { 1 },
                                                { 30 / 24.0 },
                                                { 1.2031, 1.1973, 1.2019, 1.1987, 1.2007 },
                                                { 0.5 },
                                                { 1, 0.53, 2.3, 0.7, 1.001, 3, 0.21 } };
  constexpr std::array windows{ 1, 2, 4, 8, 16, 32, 64 };
  for (const auto &durations : rates) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    MovedFilm film;
    Similarity pose{ 1, 0, 0.3, -0.2 };
    for (int i = 0; i < 120; ++i) {
      const Image map = oracle::random_image(12, 9, 0, 100, static_cast<unsigned>(i));
      const auto at = [&](int k) {
        return durations[static_cast<std::size_t>(k) % durations.size()];
      };
      if (i % 25 < 15)
        pose = pose
               * Similarity{ 1 + 0.004 * std::sin(i), 0.006 * std::cos(1.3 * i),
                             0.31 * std::sin(0.41 * i) + 0.05, 0.17 * std::cos(0.7 * i) };
      const double elapsed = i > 0 ? at(i - 1) : 0;
      pyramid.push(oracle::to_mat(map), elapsed, at(i), pose);
      film.push(map, elapsed, at(i), pose);
      std::vector<cv::Mat> means;
      pyramid.means(windows, means);
      ck_assert_uint_eq(means.size(), windows.size());
      const auto expected = film.means(windows);
      for (std::size_t w = 0; w < windows.size(); ++w) {
        const double e = oracle::difference(means[w], expected[w]);
        fail_unless(e <= 1e-3, "%g a frame, frame %d, window %d: %g", durations[0], i, windows[w],
                    e);
      }
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_still_scene)
{
  // A still scene, and a camera that moves over it by whole samples. With poses all windows equal
  // the current map, as samples that were not seen count as it does. Without poses they differ.
  // (Longer windows move several maps as one.)
  const Image world = oracle::random_image(200, 60, 0, 100, 5);
  constexpr std::array windows{ 1, 2, 4 };
  for (const bool followed : { true, false }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    double farthest = 0;
    for (int i = 0; i < 80; ++i) {
      const int left = 2 * i;
      const int top = i / 4;
      Image map(20, 15);
      for (int y = 0; y < 15; ++y)
        for (int x = 0; x < 20; ++x)
          map(x, y) = world(left + x, top + y);
      const Similarity pose{ 1, 0, 1.0 * left, 1.0 * top };
      pyramid.push(oracle::to_mat(map), 1, 1, followed ? pose : Similarity{});
      std::vector<cv::Mat> means;
      pyramid.means(windows, means);
      for (const auto &mean : means)
        farthest = std::max(farthest, oracle::difference(mean, map));
    }
    if (followed)
      fail_unless_at_most(farthest, 1e-4);
    else
      fail_unless(farthest > 20);
  }
}
GST_END_TEST;

GST_START_TEST(test_moved)
{
  TemporalPyramid pyramid(64, HistoryStart::filled);
  const Image map = oracle::random_image(6, 5, 0, 300, 7);
  for (int i = 0; i < 200; ++i) {
    // At rest, moving from frame 10 to 13, then at rest again. Frame i's windows end at i + 1. From
    // frame 76 on, the longest one begins after frame 12's display. Entries may be kept one frame
    // longer.
    const Similarity pose{ 1, 0, 0.4 * std::clamp(i - 9, 0, 4), 0 };
    pyramid.push(oracle::to_mat(map), 1, 1, pose);
    if (i < 10 || i > 77)
      fail_if(pyramid.moved(), "frame %d", i);
    else if (i < 76)
      fail_unless(pyramid.moved(), "frame %d", i);
    if (!pyramid.moved())
      for (const int window : { 1, 2, 8, 64 }) // bit-identical
        fail_unless_near(oracle::difference(mean_of(pyramid, window), map), 0, 0);
  }
  pyramid.push(oracle::to_mat(map), 1, 1, { 1, 0, 5, 0 });
  fail_unless(pyramid.moved());
  pyramid.reset();
  fail_if(pyramid.moved());
  pyramid.push(oracle::to_mat(map), 1, 1, { 1, 0, 9, 0 });
  fail_if(pyramid.moved());
  // Also if the map shares its entry with its predecessor.
  pyramid.push(oracle::to_mat(map), 0.01, 1, { 1, 0, 9, 0 });
  const std::size_t entries = pyramid.size();
  pyramid.push(oracle::to_mat(map), 0.01, 1, { 1, 0, 12, 0 });
  ck_assert_uint_eq(pyramid.size(), entries);
  fail_unless(pyramid.moved());
}
GST_END_TEST;

GST_START_TEST(test_poses_of_tiny_maps)
{
  // No sample is far enough from the border to count as seen. So means equal the current map,
  // except for moments with the same pose.
  constexpr std::array windows{ 1, 8, 64 };
  for (int height = 1; height <= 5; ++height)
    for (int width = 1; width <= 5; ++width) {
      TemporalPyramid pyramid(64, HistoryStart::filled);
      for (int i = 0; i < 70; ++i) {
        const Image map = oracle::random_image(width, height, 0, 9, static_cast<unsigned>(i));
        pyramid.push(oracle::to_mat(map), 1, 1, { 1, 0, 0.5 * i, 0 });
        std::vector<cv::Mat> means;
        pyramid.means(windows, means);
        for (const auto &mean : means) {
          fail_unless(cv::checkRange(mean, true, nullptr, 0, 9.01));
          if (std::min(width, height) <= 3)
            fail_unless_at_most(oracle::difference(mean, map), 1e-5);
        }
      }
    }
}
GST_END_TEST;

GST_START_TEST(test_paper)
{
  // Level n averages the 2ⁿ latest maps, including the current one. Map i has the value i
  // everywhere.
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
  // A film whose picture changes every second, compared every half second: frames begin at these
  // times at all these rates.
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

GST_START_TEST(test_constant_maps_are_exact)
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
  // After a million frames, nine hours at 30 fps, means are exact to float's precision.
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
  // At 3000 frames a second, several share an entry. A window that begins inside one may be off by
  // up to 1/8.
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
  // A slide, then another one. However long they last, the new one is compared with the old one.
  for (const double duration : { 30.0, 1e4, 1e18, 1e300 }) {
    TemporalPyramid pyramid(64, HistoryStart::filled);
    for (const double value : { 10.0, 10.0, 40.0 })
      pyramid.push(oracle::to_mat(Image(2, 2, value)), duration, duration);
    const double shown = TemporalPyramid::kLongestDisplay;
    fail_unless_near(mean_of(pyramid, 1).at<float>(0), 40, 1e-4);
    fail_unless_near(mean_of(pyramid, 8).at<float>(0), (40 * shown + 10 * (8 - shown)) / 8, 1e-4);
    // Once displaced, it fills all of its own display.
    pyramid.push(oracle::to_mat(Image(2, 2, 0)), duration, 1);
    fail_unless_near(mean_of(pyramid, 8).at<float>(0), 40.0 * 7 / 8, 1e-4);
    ck_assert_uint_le(pyramid.size(), 70);
  }
}
GST_END_TEST;

GST_START_TEST(test_rebase)
{
  // A change of the poses' frame of reference does not change the means.
  constexpr std::array windows{ 1, 4, 16 };
  const Similarity view{ 0.02, -0.01, 300, -80 };
  TemporalPyramid plain(64, HistoryStart::filled);
  TemporalPyramid rebased(64, HistoryStart::filled);
  for (int i = 0; i < 40; ++i) {
    const Image map = oracle::random_image(12, 9, 0, 100, static_cast<unsigned>(i));
    const Similarity pose{ 1 + 0.01 * i, 0.002 * i, 0.4 * i, -0.1 * i };
    if (i == 20)
      rebased.rebase(view);
    plain.push(oracle::to_mat(map), 1, 1, pose);
    rebased.push(oracle::to_mat(map), 1, 1, i < 20 ? pose : view * pose);
    std::vector<cv::Mat> expected;
    std::vector<cv::Mat> means;
    plain.means(windows, expected);
    rebased.means(windows, means);
    for (std::size_t w = 0; w < windows.size(); ++w)
      fail_unless_at_most(cv::norm(means[w], expected[w], cv::NORM_INF), 1e-3);
  }
}
GST_END_TEST;

GST_START_TEST(test_settle)
{
  // Of what a window's mean lacks of the current map, `share` is made up. What is above stays.
  constexpr std::array windows{ 1, 2, 4, 8, 16, 32, 64 };
  for (const double share : { 0.0, 0.25, 0.5, 1.0 })
    for (const int frames : { 1, 2, 80 }) {
      TemporalPyramid pyramid(64, HistoryStart::filled);
      Image map;
      for (int i = 0; i < frames; ++i) {
        map = oracle::random_image(6, 5, 0, 100, static_cast<unsigned>(i));
        pyramid.push(oracle::to_mat(map), 1, 1);
      }
      Image shares(6, 5, share);
      for (int x = 0; x < 6; ++x)
        shares(x, 2) = 0;
      std::vector<cv::Mat> before;
      std::vector<cv::Mat> after;
      pyramid.means(windows, before);
      for (auto &mean : before)
        mean = mean.clone();
      pyramid.settle(oracle::to_mat(shares));
      pyramid.means(windows, after);
      for (std::size_t w = 0; w < windows.size(); ++w)
        for (int y = 0; y < 5; ++y)
          for (int x = 0; x < 6; ++x) {
            const double was = static_cast<double>(before[w].at<float>(y, x));
            fail_unless_near(after[w].at<float>(y, x),
                             was + shares(x, y) * std::max(0.0, map(x, y) - was), 1e-4);
          }
    }
}
GST_END_TEST;

GST_START_TEST(test_settled_past_remains)
{
  // Once settled, a sample has always been what it is, for later maps too.
  TemporalPyramid pyramid(64, HistoryStart::filled);
  for (int i = 0; i < 20; ++i)
    pyramid.push(oracle::to_mat(Image(2, 1, i < 10 ? 5 : 50)), 1, 1);
  Image shares(2, 1);
  shares(0, 0) = 1;
  pyramid.settle(oracle::to_mat(shares));
  pyramid.push(oracle::to_mat(Image(2, 1, 80)), 1, 1);
  fail_unless_near(mean_of(pyramid, 64).at<float>(0), (80 + 63 * 50) / 64.0, 1e-4);
  fail_unless_near(mean_of(pyramid, 64).at<float>(1), (80 + 10 * 50 + 53 * 5) / 64.0, 1e-4);
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
  tcase_add_test(tc, test_poses);
  tcase_add_test(tc, test_rebase);
  tcase_add_test(tc, test_still_scene);
  tcase_add_test(tc, test_moved);
  tcase_add_test(tc, test_poses_of_tiny_maps);
  tcase_add_test(tc, test_paper);
  tcase_add_test(tc, test_same_film_at_any_rate);
  tcase_add_test(tc, test_start);
  tcase_add_test(tc, test_constant_maps_are_exact);
  tcase_add_test(tc, test_long_run);
  tcase_add_test(tc, test_memory_is_bounded);
  tcase_add_test(tc, test_shared_entries);
  tcase_add_test(tc, test_long_displays);
  tcase_add_test(tc, test_settle);
  tcase_add_test(tc, test_settled_past_remains);
  return suite;
}

GST_CHECK_MAIN(temporal_pyramid);
