// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "saliency/analyzer.h"
#include "saliency/profile.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <cstddef>
#include <deque>
#include <optional>
#include <span>

namespace saliency {

/// A part of the picture in which a detector, or anyone who knows the scene, found something.
struct Region
{
  cv::Rect2d area;   ///< in frame pixels; clipped to the frame
  unsigned type = 0; ///< any number that distinguishes types
  double weight = 1; ///< of its type (RegionWeights)
};

/// Top-down saliency: the saliency map multiplied by the weights of detected regions, as top-down
/// gain is commonly modeled (Navalpakkam & Itti 2005). The paper has no such step (Section 6).
///
/// An object is salient beyond its outline, so a region is extended by two samples of the coarsest
/// center level, the reach of contrast and pooling, and by that of events (EventMap::reach). It is
/// also held for as long as an event there lasts, or a temporal window contains what passed. For
/// windows in frames that is a number of frames; for maps of single pictures it is the region's own
/// frame only. A weight of 0 therefore suppresses a moving object completely, and a detector that
/// loses an object for some frames causes no event.
///
/// A sample of which a region covers the share s is multiplied by 1 + s (weight − 1). Where regions
/// of one type overlap, the largest share counts, so detecting a face twice does not raise it
/// twice. Different types multiply, so a weight of 0 always wins.
///
/// Zero saliency stays zero: a weight says how much an event matters, not that there is one. A face
/// at rest is felt no more than anything else at rest.
/// Not thread-safe: one thread at a time.
class TopDownSaliency
{
public:
  /// Limit on regions per frame and on regions held; the oldest are dropped.
  static constexpr std::size_t kMaxRegions = 1024;

  /// `temporal`: as passed to Analyzer::analyze().
  explicit TopDownSaliency(const Profile &profile, bool temporal = true);

  /// Applies the weights of `regions` to `found`, the analysis of a frame of this size shown from
  /// `time` on. Returns `found.map` itself if there are no regions. The result is valid until the
  /// next call. If time goes back or the frame size changes, regions of earlier frames are dropped.
  const cv::Mat &compute(const Saliency &found, cv::Size frame, std::span<const Region> regions,
                         Time time);

  /// Drops the regions of earlier frames.
  void reset();

  /// How far a region is extended in every direction, in samples of a map of that size.
  double reach(cv::Size map) const;
  /// How long a region is held. With windows in frames, each frame counts 1/30 s.
  Time hold() const
  {
    return hold_;
  }

private:
  struct Remembered
  {
    Region region;
    Time age; ///< in the time of hold()
  };

  double reach_;
  Time hold_;
  bool in_frames_;                 ///< hold() counts frames
  bool events_;                    ///< events reach farther
  std::deque<Remembered> regions_; ///< newest first
  std::optional<Time> last_time_;
  cv::Size frame_;
  cv::Mat map_;
  cv::Mat1f covered_;
};

} // namespace saliency
