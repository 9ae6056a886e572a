// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatial_saliency.h"

#include "saliency/paper.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saliency {

namespace {

/// Levels of the paper, in the frame's own numbering.
FrameLevels
paper_levels(cv::Size frame)
{
  const int last = coarsest_level(frame);
  const int finest = std::min(Paper::kSaliencyLevel, last);
  return { .frame = frame,
           .lightness = {},
           .chroma = {},
           .saliency = finest,
           .finest = finest,
           .coarsest = std::min(Paper::kCenters.back() + Paper::kDeltas.back(), last),
           .camera = finest,
           .finest_chroma = finest };
}

} // namespace

FrameLevels
frame_levels(const Profile &profile, cv::Size frame)
{
  if (profile.method == Method::paper)
    return paper_levels(frame);
  int shift = 0;
  if (profile.reference_width > 0) {
    const int finest = std::min(profile.saliency_level, profile.levels.center);
    const double octaves = std::log2(static_cast<double>(std::max(frame.width, frame.height))
                                     / profile.reference_width);
    shift = std::max(static_cast<int>(std::lround(octaves)) - 2, -finest);
  }

  // Surroundedness uses one level for all channels.
  const bool contrast = profile.method == Method::events;
  const int chroma_octaves = contrast ? profile.chroma_octaves : 0;
  const int last = coarsest_level(frame);
  const auto limited = [shift, last](int level) {
    return std::min(level + shift, last);
  };

  FrameLevels levels;
  levels.frame = frame;
  levels.saliency = limited(profile.saliency_level);
  levels.lightness = { limited(profile.levels.center), limited(profile.levels.surround) };
  levels.chroma = { limited(profile.levels.center + chroma_octaves),
                    limited(profile.levels.surround + chroma_octaves) };
  levels.finest = std::min(levels.lightness.center, levels.saliency);
  levels.coarsest = std::max(levels.saliency, levels.chroma.surround);
  levels.camera = std::max(levels.finest, levels.saliency - 1);
  levels.finest_chroma = std::min({ levels.chroma.center, levels.saliency, levels.camera });
  return levels;
}

SpatialSaliency::SpatialSaliency(const Profile &profile)
    : method_(profile.method), contrast_(profile.chroma_weight),
      surroundedness_(profile.threshold_step, profile.area_exponent)
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
  const auto count = static_cast<std::size_t>(levels.coarsest) + 1;
  maps_.resize(count);
  reductions_.resize(count);
  const int center = levels.lightness.center;
  cv::Mat &map = maps_[static_cast<std::size_t>(center)];
  if (method_ != Method::pictures) {
    contrast_(pyramid, levels.lightness, levels.chroma, map, team);
    return at_saliency_level(maps_, center, levels, team);
  }
  surroundedness_(pyramid.level(center), map);
  at_saliency_level(maps_, center, levels, team).copyTo(rare_);
  rarity_map_.resize(count);
  rarity_(pyramid.level(levels.coarsest), rarity_map_[static_cast<std::size_t>(levels.coarsest)]);
  cv::multiply(rare_, at_saliency_level(rarity_map_, levels.coarsest, levels, team), rare_);
  return rare_;
}

} // namespace saliency
