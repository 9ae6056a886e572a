// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <cstddef>
#include <optional>
#include <span>

/// Chooses the player that is followed: one that plays, of these one that reports its position,
/// then what is heard, then what a media server reports coarsely. A paused film is prepared, so
/// that it is felt from its first moment on.
///
/// A listener notices some seconds late that a film has stopped. So it replaces a player only with
/// a film that it has found in sound from after that player's last moment of play, or that it still
/// hears long after. Reads no clock.
class PlayerChoice
{
public:
  struct Candidate
  {
    follow::Doing doing = follow::Doing::stopped;
    bool is_faulty = false; ///< its position is of no use
    follow::Source source = follow::Source::player;
    follow::Time found{ 0 }; ///< local time at which a listener found the film, or its place, anew
  };

  /// Sound that a listener compares is not older, and it loses a film within this time.
  static constexpr follow::Time kMemory = std::chrono::seconds(12);

  /// The index of the player to follow. `current`: of the one that is followed now.
  std::optional<std::size_t> choose(std::span<const Candidate> players,
                                    std::optional<std::size_t> current, follow::Time now);

private:
  int rank(const Candidate &player, follow::Time now) const;

  std::optional<follow::Time> played_{}; ///< a reporting player that was followed, last
  /// When a media server's player played last, if none plays now.
  std::optional<follow::Time> coarse_played_{};
  bool coarse_plays_ = false;
};
