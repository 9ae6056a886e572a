// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Stages of the analyzer: what an observer sees, and the same bits on every CPU and number of
// threads.
#include "frame/front_end.h"
#include "i420_frame.h"
#include "saliency/analyzer.h"
#include "saliency/spatial_saliency.h"
#include "support/tolerance.h"

#include <hwy/targets.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "support/check_tests.h"

namespace {

/// The first is converted to L*a*b* at every pixel, the second is decimated first.
const cv::Size kSizes[] = { { 500, 300 }, { 900, 540 } };
constexpr saliency::Time kFrame{ 1'000'000'000 / 30 };

using Frames = std::vector<oracle::Frame>;

/// A ball, then a camera that pans over the texture, then another shot.
Frames
film(cv::Size size)
{
  Frames pictures;
  for (int i = 0; i < 20; ++i)
    pictures.push_back(oracle::film(size.width, size.height, i));
  oracle::Frame wide = oracle::textured(size.width + 60, size.height);
  for (int i = 20; i < 50; ++i) {
    oracle::Frame &seen = pictures.emplace_back(size.width, size.height);
    const int left = i < 40 ? 2 * (i - 20) : 0;
    for (std::size_t c = 0; c < 3; ++c)
      for (int y = 0; y < seen.plane_height(c); ++y)
        for (int x = 0; x < seen.plane_width(c); ++x)
          seen.at(c, x, y) = static_cast<std::uint8_t>(
              i < 40 ? wide.at(c, x + left / (c == 0 ? 1 : 2), y)
                     : 255 - wide.at(c, x, y) + 90 * (c == 1 ? x / 40 % 2 : 0));
  }
  return pictures;
}

} // namespace

CHECK_TEST(test_observer)
{
  // Each stage is observed once, in order. Observing changes nothing.
  using saliency::Stage;
  constexpr std::array kAll{ Stage::lab,     Stage::pyramid, Stage::camera,        Stage::shot_cut,
                             Stage::spatial, Stage::history, Stage::spatiotemporal };
  constexpr std::array kSpatial{ Stage::lab, Stage::pyramid, Stage::spatial };
  for (const auto &profile : { saliency::Profile::tuned(), saliency::Profile::paper() }) {
    saliency::Analyzer analyzer(profile);
    saliency::Analyzer observed(profile);
    std::vector<Stage> stages;
    cv::Mat seen_spatial;
    cv::Mat seen_spatiotemporal;
    observed.set_observer([&](Stage stage, const cv::Mat &map) {
      stages.push_back(stage);
      if (stage == Stage::spatial)
        map.copyTo(seen_spatial);
      else if (stage == Stage::spatiotemporal)
        map.copyTo(seen_spatiotemporal);
      else
        fail_unless(map.empty());
    });
    saliency::Analyzer spatial(profile);
    int cuts = 0;
    saliency::Time time{ 0 };
    for (const oracle::Frame &frame : film(kSizes[0])) {
      stages.clear();
      const auto &expected = analyzer.analyze(frame.view(), time, kFrame);
      const auto &found = observed.analyze(frame.view(), time, kFrame);
      fail_unless(std::ranges::equal(stages, kAll));
      const auto &alone = spatial.analyze(frame.view(), time, kFrame, false);
      fail_unless(cv::norm(seen_spatial, alone.map, cv::NORM_INF) == 0, "spatial map");
      fail_unless(cv::norm(seen_spatiotemporal, expected.map, cv::NORM_INF) == 0,
                  "spatiotemporal map");
      fail_unless(cv::norm(found.map, expected.map, cv::NORM_INF) == 0);
      cuts += found.cut ? 1 : 0;
      time += kFrame;
    }
    fail_unless((cuts > 0) == (profile.method != saliency::Method::paper));
    stages.clear();
    observed.analyze(oracle::textured(90, 60).view(), time, kFrame, false);
    fail_unless(std::ranges::equal(stages, kSpatial));
  }
}

CHECK_TEST(test_lab)
{
  // An L*a*b* image gives what its frame gives, to within the front end's fixed point.
  for (const cv::Size size : kSizes) {
    auto profile = saliency::Profile::tuned();
    profile.exact = true;
    saliency::Analyzer analyzer(profile);
    saliency::Analyzer of_lab(profile);
    saliency::FrontEnd front_end;
    const int level = saliency::frame_levels(profile, size).finest;
    bool moved = false;
    int cuts = 0;
    double difference = 0;
    double energy = 0;
    saliency::Time time{ 0 };
    for (const oracle::Frame &frame : film(size)) {
      const auto &expected = analyzer.analyze(frame.view(), time, kFrame);
      const auto lab = saliency::to_float(front_end.lab(frame.view(), level, 0));
      const auto &found = of_lab.analyze(lab, size, time, kFrame);
      difference += cv::norm(found.map, expected.map, cv::NORM_L2SQR);
      energy += cv::norm(expected.map, cv::NORM_L2SQR);
      fail_unless(found.picture == expected.picture);
      fail_unless(found.cut == expected.cut && found.camera_moves == expected.camera_moves);
      moved = moved || found.camera_moves;
      cuts += found.cut ? 1 : 0;
      time += kFrame;
    }
    fail_unless(moved && cuts > 0);
    fail_unless(energy > 0);
    fail_unless_at_most(std::sqrt(difference / energy), 0.01);
  }
}

static std::vector<cv::Mat>
maps(const saliency::Profile &profile, const Frames &film, int threads)
{
  saliency::Analyzer analyzer(profile);
  analyzer.set_threads(threads);
  std::vector<cv::Mat> found;
  saliency::Time time{ 0 };
  for (const oracle::Frame &frame : film) {
    found.push_back(analyzer.analyze(frame.view(), time, kFrame).map.clone());
    time += kFrame;
  }
  return found;
}

static void
fail_unless_same_bits(const std::vector<cv::Mat> &found, const std::vector<cv::Mat> &expected,
                      const std::string &how)
{
  for (std::size_t i = 0; i < expected.size(); ++i)
    fail_unless(std::memcmp(found[i].data, expected[i].data, expected[i].total() * sizeof(float))
                    == 0,
                "%s: frame %zu", how.c_str(), i);
}

CHECK_TEST(test_targets)
{
  // Results are equal with all instruction sets of this CPU.
  const auto targets = hwy::SupportedTargets();
  for (const cv::Size size : kSizes) {
    const Frames pictures = film(size);
    const auto expected = maps(saliency::Profile::tuned(), pictures, 1);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::GetChosenTarget().Update(target);
      const auto found = maps(saliency::Profile::tuned(), pictures, 1);
      hwy::GetChosenTarget().Update(targets);
      fail_unless_same_bits(found, expected, hwy::TargetName(target));
    }
  }
}

CHECK_TEST(test_threads)
{
  // Results are equal with any number of threads.
  for (const auto &[profile, size] : { std::pair{ saliency::Profile::tuned(), kSizes[0] },
                                       { saliency::Profile::tuned(), kSizes[1] },
                                       { saliency::Profile::paper(), kSizes[0] } }) {
    const Frames pictures = film(size);
    const auto expected = maps(profile, pictures, 1);
    for (const int threads : { 2, 3, 8 })
      fail_unless_same_bits(maps(profile, pictures, threads), expected,
                            std::to_string(threads) + " threads");
  }
}

CHECK_MAIN(stages)
