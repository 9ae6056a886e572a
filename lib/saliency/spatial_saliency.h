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
  cv::Size frame;                ///< the size of level 0
  std::vector<LevelPair> pairs;  ///< of lightness
  std::vector<LevelPair> chroma; ///< for each of these
  int saliency = 0;              ///< of the spatial saliency map
  int finest = 0;                ///< finest and coarsest level among the pairs
  int coarsest = 0;
  int camera = 0;        ///< of the camera's motion: one finer than the map's, if any
  int finest_chroma = 0; ///< finest level whose a* and b* are used
};

/// With a reference width, level 2 is the level whose larger side is nearest to it in octaves,
/// shifted if needed so that no level is below 0. A pair whose levels are limited to the same level
/// has no contrast.
FrameLevels frame_levels(const Profile &profile, cv::Size frame);

/// Spatial saliency S (paper, Section 3: "contrast maps are linearly combined to yield [a] single …
/// saliency map"). The profile may replace contrast by surroundedness and multiply by color rarity.
class SpatialSaliency
{
public:
  explicit SpatialSaliency(const Profile &profile);

  /// Sum or mean of the (normalized) contrast maps at the saliency level: finer maps are reduced
  /// like the pyramid, coarser ones upsampled on its grid. `pyramid` holds L*a*b* levels
  /// finest…coarsest. The result is CV_32FC1, ≥ 0, valid until the next call.
  const cv::Mat &compute(const Pyramid &pyramid, const FrameLevels &levels, const Team &team = {});

private:
  /// Resamples `maps[level]` to the saliency level; uses the entries in between as buffers.
  const cv::Mat &at_saliency_level(std::vector<cv::Mat> &maps, int level, const FrameLevels &levels,
                                   const Team &team);

  SpatialCue cue_;
  Normalization normalization_;
  bool mean_;
  Contrast contrast_;
  Surroundedness surroundedness_;
  bool weigh_by_rarity_;
  Rarity rarity_;
  std::vector<cv::Mat> contrast_map_; ///< of one pair, by level: from its center's on
  std::vector<cv::Mat> rarity_map_;   ///< by level, too
  std::vector<Reduction> reductions_; ///< of these maps, by source level
  cv::Mat upsampled_;
  cv::Mat sum_;
};

} // namespace saliency
