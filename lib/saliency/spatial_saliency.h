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

/// A profile's levels in the numbering of one frame size's own pyramid, limited to the levels that
/// it has.
struct FrameLevels
{
  cv::Size frame;                ///< the size of level 0
  std::vector<LevelPair> pairs;  ///< of lightness
  std::vector<LevelPair> chroma; ///< of each of these
  int saliency = 0;              ///< of the spatial saliency map
  int finest = 0;                ///< finest and coarsest level among the pairs
  int coarsest = 0;
  int finest_chroma = 0; ///< level at which a* and b* are looked at
};

/// With a reference width, level 2 is the level whose larger side is nearest to it in octaves, as
/// far as no level of the profile falls below 0. A pair whose two levels are limited to the same
/// one has no contrast.
FrameLevels frame_levels(const Profile &profile, cv::Size frame);

/// Spatial saliency S (paper, Section 3: "contrast maps are linearly combined to yield [a] single …
/// saliency map"), or surroundedness in the place of contrast; times color rarity where the
/// profile asks for it.
class SpatialSaliency
{
public:
  explicit SpatialSaliency(const Profile &profile);

  /// Sum or mean of the (normalized) contrast maps at the saliency level: finer ones are reduced to
  /// it as the pyramid is, coarser ones upsampled on its grid. `pyramid` holds the L*a*b* levels
  /// finest…coarsest. CV_32FC1, ≥ 0, valid until the next call.
  const cv::Mat &compute(const Pyramid &pyramid, const FrameLevels &levels, const Team &team = {});

private:
  /// Brings a map from its level to the saliency level; `maps[level]` is the map and what is finer
  /// than the saliency level is filled up to it.
  const cv::Mat &at_saliency_level(std::vector<cv::Mat> &maps, int level, const FrameLevels &levels,
                                   const Team &team);

  SpatialCue cue_;
  Normalization normalization_;
  bool mean_;
  Contrast contrast_;
  Surroundedness surroundedness_;
  bool weigh_by_rarity_;
  Rarity rarity_;
  std::vector<cv::Mat>
      contrast_map_; ///< of one pair, by level: at its center's, and reduced from there on
  std::vector<cv::Mat> rarity_map_;   ///< likewise
  std::vector<Reduction> reductions_; ///< of these, from each level
  cv::Mat upsampled_;
  cv::Mat sum_;
};

} // namespace saliency
