// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/position_estimator.h"
#include "tracks/cue_builder.h"
#include "tracks/track.h"

#include <optional>
#include <vector>

namespace follow {

/// A film's track → cues in local time, a little ahead of where the film is. Known ahead, they
/// leave early enough for any motor. Reads no clock; not thread-safe.
class TrackFollower
{
public:
  struct Step
  {
    bool silence = false;             ///< at once, and drop cues of earlier steps
    std::vector<tactile::Cue> cues{}; ///< in local times, without gaps
  };

  /// Another film, or none. The next step is silence if one plays.
  void set_track(std::optional<tactile::Track> track);
  /// The film's track was edited while it may play: what was handed on stays.
  void edit_track(tactile::Track track);
  /// Estimates are those of another player of the film from now on.
  void change_player();

  /// How much later than the player says its picture is on the screen; may be negative.
  void set_offset(Time later);

  /// Cues from the last step's on, up to `ahead` of now. None where the film stands or is unknown.
  Step step(const std::optional<PositionEstimator::Estimate> &estimate, Time now, Time ahead);

private:
  tactile::Cue next_cue(Time begin) const;

  std::optional<tactile::Track> track_;
  Time offset_{ 0 };
  bool plays_ = false;
  std::uint64_t stretch_ = 0;
  Time next_{ 0 }; ///< film time up to which there are cues
};

} // namespace follow
