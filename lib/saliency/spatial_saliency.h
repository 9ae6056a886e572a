// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/contrast.h"
#include "saliency/profile.h"
#include "saliency/pyramid.h"
#include "saliency/rarity.h"
#include "saliency/surroundedness.h"

#include <opencv2/core/mat.hpp>

#include <vector>

namespace saliency {

/// A profile's levels in the numbering of one frame size, limited to the levels of that frame.
struct FrameLevels
{
  cv::Size frame;      ///< the size of level 0
  LevelPair lightness; ///< of contrast; Paper has pairs of its own
  LevelPair chroma;
  int saliency = 0; ///< of the spatial saliency map
  int finest = 0;   ///< finest and coarsest level in use
  int coarsest = 0;
  int camera = 0;        ///< of the camera's motion: one finer than the map's, if any
  int finest_chroma = 0; ///< finest level whose a* and b* are used
};

/// With a reference width, level 2 is the level whose larger side is nearest to it in octaves,
/// shifted if needed so that no level is below 0. A pair whose levels are limited to the same level
/// has no contrast.
FrameLevels frame_levels(const Profile &profile, cv::Size frame);

/// Spatial saliency of all methods but the paper's: contrast, or surroundedness times color rarity.
class SpatialSaliency
{
public:
  explicit SpatialSaliency(const Profile &profile);

  /// The map at the saliency level: a finer one is reduced like the pyramid, a coarser one
  /// upsampled on its grid. `pyramid` holds L*a*b* levels finest…coarsest. The result is CV_32FC1,
  /// ≥ 0, valid until the next call.
  const cv::Mat &compute(const Pyramid &pyramid, const FrameLevels &levels, const Team &team = {});

private:
  /// Resamples `maps[level]` to the saliency level; uses the entries in between as buffers.
  const cv::Mat &at_saliency_level(std::vector<cv::Mat> &maps, int level, const FrameLevels &levels,
                                   const Team &team);

  Method method_;
  Contrast contrast_;
  Surroundedness surroundedness_;
  Rarity rarity_;
  std::vector<cv::Mat> maps_;         ///< of contrast or surroundedness, by level
  std::vector<cv::Mat> rarity_map_;   ///< by level, too
  std::vector<Reduction> reductions_; ///< of these maps, by source level
  cv::Mat upsampled_;
  cv::Mat rare_; ///< surroundedness × rarity
};

} // namespace saliency
