// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/position_estimator.h"
#include "tracks/cue_builder.h"
#include "tracks/draft.h"

#include <memory>
#include <optional>
#include <vector>

namespace follow {

/// A film's track → cues in local time, a little ahead of the position of the film, so that they
/// leave early enough for any motor. Parts of the track that are unknown at that time are silent.
/// Reads no clock; not thread-safe.
class TrackFollower
{
public:
  struct Step
  {
    bool silence = false;             ///< at once, and drop cues of earlier steps
    std::vector<tactile::Cue> cues{}; ///< in local times, without gaps
  };

  /// Sets the track of another film, or none. The next step is silence if one plays. The track may
  /// become known meanwhile.
  void set_track(std::shared_ptr<const tactile::Draft> track);
  /// Estimates are those of another player of the film from now on.
  void change_player();

  /// How much later than the player shows a picture it is felt; may be negative.
  void set_delay(Time later);

  /// Cues from the last step's on, up to `ahead` of now. None where the film stands or is unknown.
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
