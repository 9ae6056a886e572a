// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatial_saliency.h"

#include "saliency/normalization.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saliency {

FrameLevels
frame_levels(const Profile &profile, cv::Size frame)
{
  int shift = 0;
  if (profile.reference_width > 0) {
    int finest = profile.saliency_level;
    for (const auto &pair : profile.levels)
      finest = std::min({ finest, pair.center, pair.surround });
    const double octaves = std::log2(static_cast<double>(frame.width) / profile.reference_width);
    shift = std::max(static_cast<int>(std::lround(octaves)) - 2, -finest);
  }

  const int last = coarsest_level(frame);
  const auto limited = [shift, last](int level) {
    return std::min(level + shift, last);
  };

  FrameLevels levels;
  levels.frame = frame;
  levels.saliency = limited(profile.saliency_level);
  levels.finest = last;
  levels.coarsest = levels.saliency;
  for (const auto &pair : profile.levels) {
    const LevelPair own{ limited(pair.center), limited(pair.surround) };
    const LevelPair chroma{ limited(pair.center + profile.chroma_octaves),
                            limited(pair.surround + profile.chroma_octaves) };
    levels.pairs.push_back(own);
    levels.chroma.push_back(chroma);
    levels.finest = std::min(levels.finest, own.center);
    levels.coarsest = std::max(levels.coarsest, chroma.surround);
  }
  return levels;
}

SpatialSaliency::SpatialSaliency(const Profile &profile)
    : normalization_(profile.contrast_normalization), mean_(profile.contrast_mean),
      contrast_(profile.chroma_weight)
{
}

const cv::Mat &
SpatialSaliency::compute(const Pyramid &pyramid, const FrameLevels &levels)
{
  contrast_map_.resize(static_cast<std::size_t>(std::max(levels.coarsest, levels.saliency)) + 1);
  bool first = true;
  for (std::size_t i = 0; i < levels.pairs.size(); ++i) {
    auto center = static_cast<std::size_t>(levels.pairs[i].center);
    contrast_(pyramid, levels.pairs[i], levels.chroma[i], contrast_map_[center]);
    if (normalization_ == Normalization::itti)
      normalize_itti(contrast_map_[center]);

    for (; static_cast<int>(center) < levels.saliency; ++center)
      reduce(contrast_map_[center], contrast_map_[center + 1]);
    const cv::Mat *map = &contrast_map_[center];
    if (const int octaves = static_cast<int>(center) - levels.saliency; octaves > 0) {
      upsample(*map, octaves, octaves, level_size(levels.frame, levels.saliency), upsampled_);
      map = &upsampled_;
    }

    if (first)
      map->copyTo(sum_);
    else
      cv::add(sum_, *map, sum_);
    first = false;
  }
  if (mean_ && levels.pairs.size() > 1)
    sum_ *= 1.0 / static_cast<double>(levels.pairs.size());
  return sum_;
}

} // namespace saliency
