// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/position_estimator.h"
#include "tracks/cue_builder.h"
#include "tracks/draft.h"

#include <memory>
#include <optional>
#include <vector>

namespace follow {

/// Computes cues in local time from a film's track, so far ahead of the film's position that any
/// motor is on time. Parts of the track that are unknown by then are silent. Reads no clock; not
/// thread-safe.
class TrackFollower
{
public:
  struct Step
  {
    bool silence = false;             ///< at once, and drop cues of earlier steps
    std::vector<tactile::Cue> cues{}; ///< in local times, without gaps
    std::optional<Time> until{};      ///< local time to which all cues so far reach
  };

  /// Sets the track of another film, or none. The next step is silence if one plays. The track may
  /// become known meanwhile.
  void set_track(std::shared_ptr<const tactile::Draft> track);
  /// From now on, estimates are those of another player.
  void change_player();

  /// Delay of the vibration against the player's picture; may be negative.
  void set_delay(Time later);

  /// Cues after those of the last step, up to `ahead` of now; none while the film stands or its
  /// position is unknown.
  Step step(const std::optional<PositionEstimator::Estimate> &estimate, Time now, Time ahead);

private:
  tactile::Cue next_cue(Time begin) const;

  std::shared_ptr<const tactile::Draft> track_;
  Time offset_{ 0 };
  bool plays_ = false;
  std::uint64_t stretch_ = 0;
  Time next_{ 0 }; ///< film time up to which there are cues
};

} // namespace follow
