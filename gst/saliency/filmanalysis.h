// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "framemapping.h"
#include "saliency/analyzer.h"
#include "saliency/top_down_saliency.h"
#include "saliencysettings.h"
#include "tactile/orientation.h"
#include "tactile/picture_map.h"
#include "tactile/tactile_mapping.h"
#include "tactile/viewport.h"

#include <optional>

/// What saliencytactile makes of a film: frame → saliency map, weighed → tactile map, turned as the
/// picture is, and how often. Streaming thread only, or while it is stopped.
class FilmAnalysis
{
public:
  /// The saliency map as it lies on the picture; empty if there is none.
  struct AttachedSaliency
  {
    tactile::PictureMap map;
    gfloat floor = 0; ///< its maximum exceeds this where something is felt
  };

  /// Forgets what went before: what comes does not follow it.
  void forget();
  /// forget(), and the maps.
  void reset();
  /// reset(), and memory is given back until the next frame.
  void stop();

  /// Whether a frame of this time is to be analyzed under max-rate: the first one at or after each
  /// point of a regular grid, which begins anew after a jump in time. Always where the last map is
  /// for another grid or made in another way.
  bool is_due(const SaliencySettings &settings, tactile::Orientation orientation,
              saliency::Time time);

  /// Analyzes a frame. Where it could not be read that is false and the map silent. What throws is
  /// memory that is out: std::bad_alloc, or OpenCV's exception of it.
  bool analyze(const SaliencySettings &settings, tactile::Orientation orientation,
               const GstVideoInfo &info, GstBuffer *buffer, saliency::Time time,
               saliency::Time duration);

  /// Of the last analysis, as seen on the screen.
  const tactile::TactileMap &map() const
  {
    return map_;
  }
  /// Of the last analysis, if SaliencySettings::attach_saliency was set.
  const AttachedSaliency &saliency() const
  {
    return saliency_;
  }

private:
  /// What an analyzer is made for.
  struct Kind
  {
    ProfileName profile = ProfileName::tuned;
    bool temporal = true;
    bool exact = false;

    bool operator==(const Kind &) const = default;
  };

  static Kind kind_of(const SaliencySettings &settings);
  void make_analyzer(const Kind &kind);
  const cv::Mat &weigh(const SaliencySettings &settings, GstBuffer *buffer,
                       const FrameMapping &mapping, const saliency::Saliency &found,
                       saliency::Time time);
  void keep_saliency(const tactile::SaliencyView &view, double floor);

  Kind kind_; ///< that the analyzer is made for
  std::optional<saliency::Analyzer> analyzer_;
  std::optional<saliency::TopDownSaliency> top_down_; ///< there when the analyzer is
  tactile::AdaptiveViewport viewport_;
  tactile::Orientation orientation_; ///< that map_ is for
  tactile::TactileMap stored_map_;   ///< as it lies on the pixels
  tactile::TactileMap map_;
  AttachedSaliency saliency_;
  std::optional<saliency::Time> next_analysis_; ///< on max-rate's grid; none: the next frame
  saliency::Time last_time_{ 0 };               ///< of the last frame
};
