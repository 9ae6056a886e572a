// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/paper.h"

#include "frame/levels.h"
#include "saliency/normalization.h"
#include "saliency/rows.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace saliency {

namespace {

/// A map of zeros; cv::Mat::setTo allocates.
template <typename Sample>
void
make_zero(cv::Mat &map, cv::Size size)
{
  map.create(size, cv::traits::Type<Sample>::value);
  std::fill_n(map.ptr<Sample>(), map.total(), Sample{});
}

} // namespace

const cv::Mat &
Paper::spatial(const Pyramid &lab, cv::Size frame, const Team &team)
{
  const auto limited = [last = coarsest_level(frame)](int level) {
    return std::min(level, last);
  };
  const int level = limited(kSaliencyLevel);
  make_zero<float>(spatial_, level_size(frame, level));
  for (std::size_t i = 0; i < kCenters.size(); ++i)
    for (const int delta : kDeltas) {
      const LevelPair pair{ limited(kCenters[i]), limited(kCenters[i] + delta) };
      cv::Mat &map = contrast_maps_[i];
      contrast_(lab, pair, pair, map, team);
      normalize_itti(map);
      if (const int octaves = pair.center - level; octaves > 0) {
        upsample(map, octaves, octaves, spatial_.size(), upsampled_);
        cv::add(spatial_, upsampled_, spatial_);
      } else {
        cv::add(spatial_, map, spatial_);
      }
    }
  return spatial_;
}

const cv::Mat &
Paper::spatiotemporal(const cv::Mat &map, const Team &team)
{
  if (count_ == 0)
    make_zero<double>(sum(0), map.size());
  const cv::Mat &before = sum(count_++);
  cv::Mat &now = sum(count_);
  now.create(map.size(), CV_64FC1);
  rows::integrate(before.ptr<double>(), map.ptr<float>(), map.total(), now.ptr<double>());

  team.each(static_cast<int>(means_.size()), [&](int level) {
    const auto n = static_cast<std::size_t>(level);
    const std::size_t frames = std::min(std::size_t{ 1 } << n, count_);
    means_[n].create(map.size(), CV_32FC1);
    rows::difference(sum(count_ - frames).ptr<double>(), now.ptr<double>(),
                     1 / static_cast<double>(frames), map.total(), means_[n].ptr<float>());
  });

  make_zero<float>(spatiotemporal_, map.size());
  auto *out = spatiotemporal_.ptr<float>();
  for (const int c : kTemporalCenters)
    for (const int delta : kDeltas) {
      const auto *center = means_[static_cast<std::size_t>(c)].ptr<float>();
      const auto *surround = means_[static_cast<std::size_t>(c + delta)].ptr<float>();
      for (std::size_t i = 0; i < map.total(); ++i)
        out[i] += std::abs(center[i] - surround[i]);
    }
  normalize_itti(spatiotemporal_);
  return spatiotemporal_;
}

} // namespace saliency
