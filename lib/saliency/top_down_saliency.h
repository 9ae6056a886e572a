// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/analyzer.h"
#include "saliency/profile.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <cstddef>
#include <deque>
#include <optional>
#include <span>

namespace saliency {

/// A part of the picture in which someone who knows what is to be seen found something.
struct Region
{
  cv::Rect2d area;   ///< in the frame's pixels; what is outside the frame does not count
  unsigned type = 0; ///< what was found: any number that tells the types apart
  double weight = 1; ///< of its type (see RegionWeights)
};

/// Saliency as knowledge of the scene changes it, which the paper's has none of (Section 6):
/// multiplied by the weights of the regions in which something was found, as top-down gain is
/// commonly modeled (Navalpakkam & Itti 2005).
///
/// What is salient about an object is not in its outline alone, so a region reaches further, by the
/// two samples of the coarsest center level that contrast and pooling spread it, and it stays for
/// as long as a temporal window holds what has passed there: so many frames where windows are meant
/// in frames, no longer than its own frame where the map is of single pictures. A weight of 0 thus
/// takes away all that the object does, also where it moves, and a detector that loses an object
/// for some frames makes no event of it.
///
/// A sample that a region covers by a share s of what it has of the picture is multiplied by
/// 1 + s (weight − 1). Where regions overlap, those of one type count once, by the largest share: a
/// detector that finds a face twice does not raise it twice. Different types multiply, so that 0 is
/// 0 whatever else is there.
///
/// What is not salient stays so: a weight says how much an event matters, not that there is one. A
/// face at rest is no more felt than anything else at rest.
///
/// Not thread-safe: one thread at a time.
class TopDownSaliency
{
public:
  /// More regions in a frame, or remembered, are left out, the oldest first.
  static constexpr std::size_t kMaxRegions = 1024;

  /// `temporal`: as the maps were analyzed (see Analyzer::analyze).
  explicit TopDownSaliency(const Profile &profile, bool temporal = true);

  /// The map of `found`, an analysis of a frame of this size shown from `time` on, with the weights
  /// of the regions found in it; where there is nothing to weigh that is `found.map` itself. Valid
  /// until the next call. Time that goes back, or a frame of another size, forgets the regions of
  /// earlier frames.
  const cv::Mat &compute(const Saliency &found, cv::Size frame, std::span<const Region> regions,
                         Time time);

  /// Forgets the regions of earlier frames.
  void reset();

  /// How far a region reaches in every direction, in samples of the map, and how long after it was
  /// found; where windows are meant in frames one counts 1/30 s.
  double reach() const
  {
    return reach_;
  }
  Time hold() const
  {
    return hold_;
  }

private:
  struct Remembered
  {
    Region region;
    Time age; ///< in hold()'s time
  };

  double reach_;
  Time hold_;
  bool in_frames_;                 ///< hold() counts frames
  std::deque<Remembered> regions_; ///< the newest first
  std::optional<Time> last_time_;
  cv::Size frame_;
  cv::Mat map_;
  cv::Mat1f covered_;
};

} // namespace saliency
