// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/top_down_saliency.h"

#include "support/tolerance.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "support/check_tests.h"

using saliency::Profile;
using saliency::Region;
using saliency::Saliency;
using saliency::Time;
using saliency::TopDownSaliency;
using namespace std::chrono_literals;

namespace {

constexpr int kStep = 16; // pixels between samples of level 4

/// A random saliency map of a frame of this size.
Saliency
random_saliency(cv::Size frame, unsigned seed)
{
  Saliency found;
  found.map.create((frame.height + kStep - 1) / kStep, (frame.width + kStep - 1) / kStep, CV_32FC1);
  cv::RNG generator(seed);
  generator.fill(found.map, cv::RNG::UNIFORM, 0, 10);
  found.picture = { 0.5 - 0.5 / kStep, 0.5 - 0.5 / kStep, frame.width * 1.0 / kStep,
                    frame.height * 1.0 / kStep };
  return found;
}

/// The sample at a place of the picture, in samples. Places outside count as the nearest sample.
int
sample_at(double place, int samples)
{
  return std::clamp(static_cast<int>(std::floor(place)), 0, samples - 1);
}

/// By definition, on a grid of 1/32 sample: all edges lie on its lines.
cv::Mat1d
factors(const Saliency &found, const std::vector<Region> &regions, double reach)
{
  constexpr int kFine = 32;
  const cv::Size size = found.map.size();
  std::map<unsigned, cv::Mat1d> largest; // share of a sample, by type
  std::map<unsigned, double> weight;
  for (const Region &region : regions) {
    cv::Mat1d inside(size, 0.0);
    cv::Mat1d all(size, 0.0);
    for (int y = 0; y < found.picture.height * kFine; ++y)
      for (int x = 0; x < found.picture.width * kFine; ++x) {
        const double px = (x + 0.5) / kFine;
        const double py = (y + 0.5) / kFine;
        const int column = sample_at(found.picture.x + px, size.width);
        const int row = sample_at(found.picture.y + py, size.height);
        all(row, column) += 1;
        inside(row, column) += px > region.area.x / kStep - reach
                               && px < (region.area.x + region.area.width) / kStep + reach
                               && py > region.area.y / kStep - reach
                               && py < (region.area.y + region.area.height) / kStep + reach;
      }
    const cv::Mat1d share = inside / all;
    auto [entry, is_new] = largest.try_emplace(region.type, share);
    if (!is_new)
      entry->second = cv::max(entry->second, share);
    weight[region.type] = region.weight;
  }
  cv::Mat1d product(size, 1.0);
  for (const auto &[type, share] : largest)
    product = product.mul(1 + share * (weight[type] - 1));
  return product;
}

void
fail_unless_weighed(const cv::Mat &map, const Saliency &found, const cv::Mat1d &factor)
{
  fail_unless(map.size() == found.map.size());
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      fail_unless_near(map.at<float>(y, x),
                       static_cast<double>(found.map.at<float>(y, x)) * factor(y, x), 1e-4);
}

} // namespace

/// Regions at any place and of any size, also beyond the frame, overlapping, of several types.
CHECK_TEST(test_definition)
{
  std::mt19937 generator(23);
  const auto pixel = [&](int from, int to) {
    return from + static_cast<int>(generator() % static_cast<unsigned>(to - from));
  };
  for (int i = 0; i < 40; ++i) {
    const cv::Size frame(pixel(1, 200), pixel(1, 150));
    const Saliency found = random_saliency(frame, generator());
    std::vector<Region> regions;
    for (int n = pixel(1, 5); n > 0; --n) {
      const unsigned type = generator() % 3;
      regions.push_back({ cv::Rect2d(pixel(-20, frame.width), pixel(-20, frame.height),
                                     pixel(1, 120), pixel(1, 120)),
                          type, type * 1.5 });
    }
    const cv::Rect2d picture(0, 0, frame.width, frame.height);
    std::erase_if(regions, [&](const Region &r) { return (r.area & picture).empty(); });
    TopDownSaliency top_down(Profile::tuned());
    const cv::Mat before = found.map.clone();
    const cv::Mat &map = top_down.compute(found, frame, regions, 0s);
    fail_unless_weighed(map, found, factors(found, regions, top_down.reach(map.size())));
    fail_unless(cv::norm(before, found.map, cv::NORM_INF) == 0, "the analyzer's map is its own");
  }
}

/// Without regions the map is passed on unchanged.
CHECK_TEST(test_no_regions)
{
  const Saliency found = random_saliency({ 160, 120 }, 1);
  TopDownSaliency top_down(Profile::tuned());
  fail_unless(top_down.compute(found, { 160, 120 }, {}, 0s).data == found.map.data);
  // Regions outside the frame and empty ones have no effect, however near.
  const std::vector<Region> outside{ { { 160, 0, 10, 10 }, 1, 0 },
                                     { { -10, 0, 10, 10 }, 1, 0 },
                                     { { 50, 50, 0, 10 }, 1, 0 },
                                     { { 4294967295.0, 4294967295.0, 4294967295.0, 1 }, 1, 0 } };
  fail_unless(top_down.compute(found, { 160, 120 }, outside, 1s).data == found.map.data);
  // As large as the type allows: the whole frame.
  const std::vector<Region> all{ { { 0, 0, 4294967295.0, 4294967295.0 }, 1, 0 } };
  fail_unless(cv::countNonZero(top_down.compute(found, { 160, 120 }, all, 2s)) == 0);
}

/// How far and how long a region has effect follows from the profile.
CHECK_TEST(test_reach_and_hold)
{
  const TopDownSaliency tuned(Profile::tuned());
  // An event is blurred by a Gaussian of .0375 of the width, that is 1.5 of 40 samples, to 2.5 σ.
  fail_unless_near(tuned.reach({ 40, 30 }), 2 + 4, 0);
  fail_unless(tuned.hold() == Time(25'000'000'000 / 30));
  // Level 4 is the coarsest center and the map is at level 2. What vanishes has effect for 64
  // frames.
  const TopDownSaliency paper(Profile::paper());
  fail_unless_near(paper.reach({ 40, 30 }), 8, 0);
  fail_unless(paper.hold() == Time(64'000'000'000 / 30));
  // In single pictures nothing of the last frame remains.
  for (const Profile &profile : { Profile::tuned_spatial(), Profile::paper() })
    fail_unless(TopDownSaliency(profile, false).hold() == Time(0));
}

/// Where windows count frames, regions stay for as many frames at any rate. Without temporal
/// contrast they do not stay.
CHECK_TEST(test_regions_stay_for_frames)
{
  const cv::Size frame(320, 64);
  const Saliency found = random_saliency(frame, 11);
  const std::vector<Region> region{ { { 100, 0, 16, 64 }, 1, 0 } };
  for (const Time period : { Time(10ms), Time(33'333'333ns), Time(100ms) })
    for (const bool temporal : { true, false }) {
      TopDownSaliency paper(Profile::paper(), temporal);
      paper.compute(found, frame, region, 0s);
      for (int i = 1; i < 70; ++i) {
        const cv::Mat &map = paper.compute(found, frame, {}, i * period);
        fail_unless((map.data != found.map.data) == (temporal && i <= 64), "frame %d", i);
      }
    }
}

/// A region keeps its effect for as long as an event lasts, at any rate, also at its former places.
CHECK_TEST(test_regions_stay)
{
  const cv::Size frame(320, 64);
  const Saliency found = random_saliency(frame, 9);
  const auto at = [](double x) {
    return Region{ { x, 0, 16, 64 }, 1, 0 };
  };
  for (const Time period : { Time(10ms), Time(33'333'333ns), Time(100ms) }) {
    TopDownSaliency top_down(Profile::tuned());
    std::vector<std::pair<Time, Region>> past;
    for (int i = 0; i < 30; ++i) {
      const Time time = i * period;
      std::vector<Region> now;
      if (i < 10) // then it is gone
        now.push_back(at(10.0 * i));
      for (const Region &region : now)
        past.emplace_back(time, region);
      std::vector<Region> expected;
      for (const auto &[then, region] : past)
        if (time - then <= top_down.hold())
          expected.push_back(region);
      fail_unless_weighed(top_down.compute(found, frame, now, time), found,
                          factors(found, expected, top_down.reach(found.map.size())));
    }
  }
}

/// A type's latest weight applies, also at former places.
CHECK_TEST(test_newest_weight)
{
  const cv::Size frame(320, 64);
  const Saliency found = random_saliency(frame, 10);
  TopDownSaliency top_down(Profile::tuned());
  const Region then{ { 0, 0, 16, 64 }, 1, 0 };
  Region now{ { 200, 0, 16, 64 }, 1, 5 };
  top_down.compute(found, frame, { &then, 1 }, 0s);
  Region expected = then;
  expected.weight = 5;
  fail_unless_weighed(top_down.compute(found, frame, { &now, 1 }, 40ms), found,
                      factors(found, { expected, now }, top_down.reach(found.map.size())));
}

CHECK_TEST(test_resets)
{
  const cv::Size frame(160, 120);
  const Saliency found = random_saliency(frame, 2);
  const std::vector<Region> all{ { { 0, 0, 160, 120 }, 1, 0 } };
  TopDownSaliency top_down(Profile::tuned());
  const auto forgets = [&](auto then) {
    top_down.compute(found, frame, all, 10s);
    fail_unless(cv::countNonZero(top_down.compute(found, frame, {}, 10s)) == 0);
    return then().data == found.map.data;
  };
  fail_unless(forgets([&] { return top_down.compute(found, frame, {}, 10s - 1ns); }));
  fail_unless(forgets([&] {
    top_down.reset();
    return top_down.compute(found, frame, {}, 10s);
  }));
  top_down.reset();
  const Saliency other = random_saliency({ 161, 120 }, 3);
  top_down.compute(found, frame, all, 10s);
  fail_unless(top_down.compute(other, { 161, 120 }, {}, 10s).data == other.map.data);
}

/// However many regions there are, the last ones count.
CHECK_TEST(test_many_regions)
{
  const cv::Size frame(160, 120);
  const Saliency found = random_saliency(frame, 4);
  std::vector<Region> regions(5000, Region{ { 0, 0, 1, 1 }, 1, 1 });
  regions.push_back({ { 0, 0, 160, 120 }, 2, 0 });
  TopDownSaliency top_down(Profile::tuned());
  for (int i = 0; i < 5; ++i)
    fail_unless(cv::countNonZero(top_down.compute(found, frame, regions, i * 10ms)) == 0);
}

CHECK_MAIN(top_down_saliency)
