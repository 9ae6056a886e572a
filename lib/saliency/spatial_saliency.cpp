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
    const double octaves = std::log2(static_cast<double>(std::max(frame.width, frame.height))
                                     / profile.reference_width);
    shift = std::max(static_cast<int>(std::lround(octaves)) - 2, -finest);
  }

  // Surroundedness uses one pair for all channels.
  const int chroma_octaves
      = profile.spatial_cue == SpatialCue::contrast ? profile.chroma_octaves : 0;
  const int last = coarsest_level(frame);
  const auto limited = [shift, last](int level) {
    return std::min(level + shift, last);
  };

  FrameLevels levels;
  levels.frame = frame;
  levels.saliency = limited(profile.saliency_level);
  levels.finest = last;
  levels.coarsest = levels.saliency;
  levels.finest_chroma = last;
  for (const auto &pair : profile.levels) {
    const LevelPair own{ limited(pair.center), limited(pair.surround) };
    const LevelPair chroma{ limited(pair.center + chroma_octaves),
                            limited(pair.surround + chroma_octaves) };
    levels.pairs.push_back(own);
    levels.chroma.push_back(chroma);
    levels.finest = std::min(levels.finest, own.center);
    levels.coarsest = std::max(levels.coarsest, chroma.surround);
    levels.finest_chroma = std::min(levels.finest_chroma, chroma.center);
  }
  const bool events = profile.temporal == Temporal::events;
  if (profile.cut_share < 1 || events)
    levels.finest = std::min(levels.finest, levels.saliency);
  if (profile.cut_share < 1)
    levels.finest_chroma = std::min(levels.finest_chroma, levels.saliency);
  levels.camera = std::max(levels.finest, levels.saliency - 1);
  if (events)
    levels.finest_chroma = std::min(levels.finest_chroma, levels.camera);
  return levels;
}

SpatialSaliency::SpatialSaliency(const Profile &profile)
    : cue_(profile.spatial_cue), normalization_(profile.contrast_normalization),
      mean_(profile.contrast_mean), contrast_(profile.chroma_weight),
      surroundedness_(profile.threshold_step, profile.area_exponent),
      weigh_by_rarity_(profile.rarity)
{
}

const cv::Mat &
SpatialSaliency::at_saliency_level(std::vector<cv::Mat> &maps, int level, const FrameLevels &levels,
                                   const Team &team)
{
  auto index = static_cast<std::size_t>(level);
  for (; static_cast<int>(index) < levels.saliency; ++index)
    reductions_[index](maps[index], maps[index + 1], team);
  if (const int octaves = static_cast<int>(index) - levels.saliency; octaves > 0) {
    upsample(maps[index], octaves, octaves, level_size(levels.frame, levels.saliency), upsampled_);
    return upsampled_;
  }
  return maps[index];
}

const cv::Mat &
SpatialSaliency::compute(const Pyramid &pyramid, const FrameLevels &levels, const Team &team)
{
  const auto count = static_cast<std::size_t>(std::max(levels.coarsest, levels.saliency)) + 1;
  contrast_map_.resize(count);
  rarity_map_.resize(count);
  reductions_.resize(count);
  bool first = true;
  for (std::size_t i = 0; i < levels.pairs.size(); ++i) {
    const LevelPair &pair = levels.pairs[i];
    auto &contrast_map = contrast_map_[static_cast<std::size_t>(pair.center)];
    if (cue_ == SpatialCue::surroundedness)
      surroundedness_(pyramid.level(pair.center), contrast_map);
    else
      contrast_(pyramid, pair, levels.chroma[i], contrast_map, team);
    if (normalization_ == Normalization::itti)
      normalize_itti(contrast_map);

    const cv::Mat &map = at_saliency_level(contrast_map_, pair.center, levels, team);
    if (first)
      map.copyTo(sum_);
    else
      cv::add(sum_, map, sum_);
    first = false;
  }
  if (mean_ && levels.pairs.size() > 1)
    sum_ *= 1.0 / static_cast<double>(levels.pairs.size());
  if (weigh_by_rarity_) {
    rarity_(pyramid.level(levels.coarsest), rarity_map_[static_cast<std::size_t>(levels.coarsest)]);
    const cv::Mat &rarity = at_saliency_level(rarity_map_, levels.coarsest, levels, team);
    cv::multiply(sum_, rarity, sum_);
  }
  return sum_;
}

} // namespace saliency
