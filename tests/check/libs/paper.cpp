// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/paper.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "support/check_tests.h"

using oracle::Image;
using saliency::LevelPair;
using saliency::Paper;

namespace {

constexpr std::array<std::pair<int, int>, 6> kTemporalPairs{
  { { 1, 8 }, { 1, 16 }, { 2, 16 }, { 2, 32 }, { 4, 32 }, { 4, 64 } }
};

/// The mean of the last maps, of all there are if there are fewer.
Image
mean_of(const std::vector<Image> &maps, int frames)
{
  Image mean(maps[0].width, maps[0].height);
  const std::size_t count = std::min(maps.size(), static_cast<std::size_t>(frames));
  for (std::size_t i = maps.size() - count; i < maps.size(); ++i)
    for (std::size_t p = 0; p < mean.values.size(); ++p)
      mean.values[p] += maps[i].values[p] / static_cast<double>(count);
  return mean;
}

/// ST before N(·), by its definition.
Image
temporal_contrast(const std::vector<Image> &maps)
{
  Image sum(maps[0].width, maps[0].height);
  for (const auto &[c, s] : kTemporalPairs) {
    const Image center = mean_of(maps, c);
    const Image surround = mean_of(maps, s);
    for (std::size_t p = 0; p < sum.values.size(); ++p)
      sum.values[p] += std::abs(center.values[p] - surround.values[p]);
  }
  return sum;
}

} // namespace

/// Σ N(C(c, s)) for c ∈ {2,3,4}, s = c + {3,4}, in double precision; also of frames whose pyramid
/// is shorter.
CHECK_TEST(test_spatial)
{
  for (const cv::Size size : { cv::Size(1, 1),
                               { 1, 30 },
                               { 30, 1 },
                               { 3, 2 },
                               { 5, 1 },
                               { 33, 21 },
                               { 64, 48 },
                               { 300, 257 } }) {
    std::vector<oracle::LabImage> levels{ oracle::picture_of_many_scales(size.width, size.height,
                                                                         3) };
    while (levels.back()[0].values.size() > 1)
      levels.push_back(oracle::pyr_down(levels.back()));
    const int last = static_cast<int>(levels.size()) - 1;
    std::vector<LevelPair> pairs;
    for (const int c : { 2, 3, 4 })
      for (const int delta : { 3, 4 })
        pairs.push_back({ std::min(c, last), std::min(c + delta, last) });
    const int finest = std::min(2, last);

    saliency::Pyramid pyramid;
    pyramid.build(oracle::to_planes(levels[static_cast<std::size_t>(finest)]), finest,
                  std::min(8, last));
    Paper paper;
    const double e
        = oracle::difference(paper.spatial(pyramid, size),
                             oracle::spatial_saliency(levels, pairs, pairs, finest, 1, true));
    fail_unless(e <= 1e-3, "%dx%d: %g", size.width, size.height, e);
  }
}

/// Rounding errors of a gray picture are no contrast: N(·) would scale them to 1.
CHECK_TEST(test_flat_picture)
{
  const cv::Size size(40, 30);
  oracle::LabImage gray{ Image(size.width, size.height, 53.6), Image(size.width, size.height, 1e-5),
                         Image(size.width, size.height, -2e-5) };
  for (int n = 0; n < 2; ++n)
    gray = oracle::pyr_down(gray);
  saliency::Pyramid pyramid;
  pyramid.build(oracle::to_planes(gray), 2, 6);
  Paper paper;
  const cv::Mat &map = paper.spatial(pyramid, size);
  fail_unless_at_most(cv::norm(map, cv::NORM_INF), 1e-4);
  fail_unless_at_most(cv::norm(paper.spatiotemporal(map), cv::NORM_INF), 1e-4);
}

/// "A level-n image averages the spatial saliency maps of 2ⁿ previous frames including the current
/// frame." Map i has the value i everywhere.
CHECK_TEST(test_temporal_pyramid)
{
  Paper paper;
  for (int i = 0; i < 200; ++i) {
    paper.spatiotemporal(oracle::to_mat(Image(2, 2, i)));
    for (int n = 0; n <= 6; ++n) {
      const int first = std::max(0, i - (1 << n) + 1);
      fail_unless_near(paper.temporal_level(static_cast<std::size_t>(n)).at<float>(0),
                       (first + i) / 2.0, 1e-5);
    }
  }
}

CHECK_TEST(test_spatiotemporal)
{
  Paper paper;
  std::vector<Image> maps;
  for (unsigned i = 0; i < 90; ++i) {
    maps.push_back(oracle::random_image(7, 6, 0, 60, i));
    const cv::Mat &found = paper.spatiotemporal(oracle::to_mat(maps.back()));
    fail_unless_at_most(oracle::difference(found, oracle::itti(temporal_contrast(maps))), 1e-4);
    for (std::size_t n = 0; n < Paper::kTemporalLevels; ++n)
      fail_unless_at_most(oracle::difference(paper.temporal_level(n), mean_of(maps, 1 << n)), 1e-4);
  }
}

/// A ball that has long been there vanishes: the paper's windows have a ghost of 64 frames. N(·)
/// empties an even map, so there is a second sample, which stands still.
CHECK_TEST(test_ghost)
{
  Paper paper;
  for (int i = 0; i < 200; ++i) {
    Image map(2, 1, 0);
    map(0, 0) = i < 100 ? 80 : 0;
    const cv::Mat &found = paper.spatiotemporal(oracle::to_mat(map));
    const bool ghost = i >= 100 && i < 163;
    fail_unless(ghost ? found.at<float>(0) == 1 : found.at<float>(0) == 0, "frame %d: %g", i,
                static_cast<double>(found.at<float>(0)));
    fail_unless(found.at<float>(1) == 0);
  }
}

CHECK_TEST(test_reset)
{
  Paper paper;
  for (int i = 0; i < 70; ++i)
    paper.spatiotemporal(oracle::to_mat(Image(2, 2, 5)));
  paper.reset();
  fail_unless(cv::countNonZero(paper.spatiotemporal(oracle::to_mat(Image(5, 1, 9)))) == 0);
  fail_unless_near(paper.temporal_level(6).at<float>(4), 9, 0);
  paper.spatiotemporal(oracle::to_mat(Image(5, 1, 21)));
  fail_unless_near(paper.temporal_level(3).at<float>(0), 15, 1e-5);
}

/// After a million frames, nine hours at 30 fps, means are exact to float's precision.
CHECK_TEST(test_long_run)
{
  constexpr int kFrames = 1'000'000;
  const auto value = [](int i) {
    return 100 + 80 * std::sin(0.37 * i);
  };
  Paper paper;
  cv::Mat map(1, 2, CV_32FC1);
  for (int i = 0; i < kFrames; ++i) {
    map.at<float>(0) = static_cast<float>(value(i));
    map.at<float>(1) = 255;
    paper.spatiotemporal(map);
  }
  for (const int n : { 0, 3, 6 }) {
    double sum = 0;
    for (int i = 0; i < 1 << n; ++i)
      sum += value(kFrames - 1 - i);
    const cv::Mat &mean = paper.temporal_level(static_cast<std::size_t>(n));
    fail_unless_near(mean.at<float>(0), sum / (1 << n), 2e-5);
    fail_unless_near(mean.at<float>(1), 255, 0);
  }
}

CHECK_MAIN(paper)
