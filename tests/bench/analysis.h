// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame_loop.h"
#include "saliency/analyzer.h"
#include "saliency/profile.h"
#include "tactile/tactile_map.h"
#include "tactile/tactile_mapping.h"

#include <array>
#include <cstddef>

namespace bench {

/// Analysis and mapping of a film at 30 frames per second.
class Analysis
{
public:
  /// `grid`: columns × rows of tactors. `rest`: of Analyzer::set_rest().
  Analysis(const saliency::Profile &profile, const tactile::MappingSettings &mapping, cv::Size grid,
           int threads, double rest = 0);

  void frame(const saliency::FrameView &frame, std::size_t i);

private:
  saliency::Analyzer analyzer_;
  tactile::MappingSettings mapping_;
  tactile::TactileMap map_;
};

inline constexpr std::array kStageNames{ "front end", "pyramid", "camera",  "shot cut",
                                         "contrast",  "history", "temporal" };

/// Time of each stage for a frame, on one thread: medians, ms.
struct StageTimes
{
  std::array<double, kStageNames.size()> stages{}; ///< by saliency::Stage
  /// Of the front end: L*a*b* of a frame of the size after decimation. NaN for exact profiles.
  double lab = 0;
  double pooling = 0;
};

StageTimes stage_times(const saliency::Profile &profile, const tactile::MappingSettings &mapping,
                       const FrameLoop &film, int warm_up, int frames);

} // namespace bench
