// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film.h"
#include "saliency/analyzer.h"
#include "saliency/profile.h"
#include "tactile/tactile_map.h"
#include "tactile/tactile_mapping.h"
#include "quality/stages.h"

#include <array>
#include <cstddef>

namespace bench {

/// A film's way from frames to levels, at 30 frames a second.
class Analysis
{
public:
  /// `grid`: columns × rows of tactors.
  Analysis(const saliency::Profile &profile, const tactile::MappingSettings &mapping, cv::Size grid,
           int threads);

  void frame(const saliency::FrameView &frame, std::size_t i);

private:
  saliency::Analyzer analyzer_;
  tactile::MappingSettings mapping_;
  tactile::TactileMap map_;
};

/// What each stage by itself takes for a frame, on one thread: medians, ms.
struct StageTimes
{
  double front_end = 0;
  double lab
      = 0; ///< of it, on a frame of the size that decimation leaves; not known of exact profiles
  std::array<double, quality::kStages.size()> stages{}; ///< in their order
  double pooling = 0;
};

StageTimes stage_times(const saliency::Profile &profile, const tactile::MappingSettings &mapping,
                       const Film &film, int warm_up, int frames);

} // namespace bench
