// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "framereader.h"
#include "people/people.h"
#include "regionsofinterest.h"
#include "saliency/analyzer.h"
#include "saliency/top_down_saliency.h"
#include "saliencysettings.h"
#include "tactile/camera_wave.h"
#include "tactile/cue_limiter.h"
#include "tactile/density.h"
#include "tactile/orientation.h"
#include "tactile/picture_map.h"
#include "tactile/tactile_mapping.h"
#include "tactile/viewport.h"

#include <optional>

/// Analyzes a film's frames: saliency map, top-down weights, tactile map, turned as the picture is
/// shown, with limited cues. Streaming thread only, or while it is stopped.
class FilmAnalysis
{
public:
  /// In the pixels of the frame; empty if there is none.
  struct AttachedSaliency
  {
    tactile::PictureMap map;
    gfloat floor = 0; ///< a maximum above this means that something is felt
  };

  /// Forgets the history, as the next frame does not follow the last one.
  void forget();
  /// forget(), the maps, and how much was felt.
  void reset();
  /// reset(), and frees memory until the next frame.
  void stop();

  /// How the picture is turned from the next frame on. A new orientation resets the cue limits, as
  /// cells have moved. Returns whether it is new.
  bool turn(tactile::Orientation orientation);

  /// Whether a frame of this time is due under max-rate: the first at or after each point of a
  /// regular grid, which begins anew after a jump in time. Always if the last map has another grid
  /// or other settings.
  bool is_due(const SaliencySettings &settings, saliency::Time time);

  /// How often a frame of this size may be halved before analyze().
  int halvings(const SaliencySettings &settings, int width, int height);

  /// Analyzes a read frame with its metas. False if it cannot be read (`read` may be NULL); the map
  /// is silent then. Throws only where memory is out: std::bad_alloc, or OpenCV's exception.
  bool analyze(const SaliencySettings &settings, const ReadFrame *read, GstBuffer *frame,
               saliency::Time time, saliency::Time duration);

  /// Whether a late look for people is waited for, so that maps do not depend on the machine's
  /// speed; initially true.
  void wait_for_people(bool wait)
  {
    wait_for_people_ = wait;
  }
  /// Why people are not found; empty if there is no reason.
  std::string people_failure()
  {
    return people_ ? people_->failure() : std::string();
  }
  people::People::Statistics people_statistics()
  {
    return people_ ? people_->statistics() : people::People::Statistics();
  }

  /// Whether the last frame of analyze() showed nothing new, and its analysis was left out.
  bool unchanged() const
  {
    return unchanged_;
  }
  /// The map of a frame, as on the screen: that of the last analysis, or a silent one, with limited
  /// cues.
  tactile::TactileMap map(const SaliencySettings &settings, bool silent, saliency::Time time);
  /// The saliency of the last analysis, if SaliencySettings::attach_saliency was set.
  const AttachedSaliency &saliency() const
  {
    return saliency_;
  }

private:
  /// The settings and caps that require a new analyzer.
  struct Kind
  {
    ProfileName profile = ProfileName::tuned;
    bool temporal = true;
    bool exact = false;

    bool operator==(const Kind &) const = default;
  };
  /// The settings and caps that require a new detection of people.
  struct PeopleKind
  {
    PeopleMode mode = PeopleMode::off;
    bool temporal = true;

    bool operator==(const PeopleKind &) const = default;
  };

  static Kind kind_of(const SaliencySettings &settings);
  void make_analyzer(const Kind &kind);
  void make_people(const SaliencySettings &settings);
  const cv::Mat &weigh(const SaliencySettings &settings, GstBuffer *frame,
                       const Placement &placement, const saliency::FrameView &view,
                       const saliency::Saliency &found, saliency::Time time);
  void keep_saliency(const tactile::SaliencyView &view, double floor);

  Kind kind_; ///< of the analyzer
  std::optional<saliency::Analyzer> analyzer_;
  std::optional<saliency::TopDownSaliency> top_down_; ///< as the analyzer
  tactile::AdaptiveViewport viewport_;
  tactile::DensityControl density_;
  tactile::CameraWave camera_wave_;
  tactile::CueLimiter limiter_;
  tactile::Orientation orientation_;     ///< of frames
  tactile::Orientation map_orientation_; ///< of map_
  tactile::TactileMap stored_map_;       ///< in the pixels of the frame
  tactile::TactileMap map_;
  AttachedSaliency saliency_;
  PeopleKind people_kind_;               ///< of people_
  std::optional<people::People> people_; ///< none if it is off
  bool wait_for_people_ = true;
  bool unchanged_ = false;
  saliency::Saliency raised_;                   ///< by people
  std::optional<saliency::Time> next_analysis_; ///< on max-rate's grid; none: the next frame
  saliency::Time last_time_{ 0 };               ///< of the last frame
};
