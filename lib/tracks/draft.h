// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <map>
#include <optional>

namespace tactile {

/// A film's tactile maps as far as they are known: a track that is written in any order, while it
/// is played. Not thread-safe.
class Draft
{
public:
  /// Nothing is known. Rows and columns are clamped to [kMinGridSide, kMaxGridSide].
  explicit Draft(int rows = 3, int columns = 3);
  /// All is known, silence after the track's end.
  explicit Draft(const Track &track);

  int rows() const;
  int columns() const;

  /// The map at a time ≥ 0; nullptr: unknown.
  const TactileMap *at(Time time) const;
  /// When at() changes after a time; Time::max(): never.
  Time until(Time time) const;
  /// The first unknown time from here on; Time::max(): none.
  Time known_until(Time time) const;

  /// Makes the map known from `begin` to before `end`, in place of what was known there. Does
  /// nothing where that is no span. Fails and leaves the draft unchanged if the map has another
  /// grid, if a time is negative or beyond Track::kMaxEnd, or if the draft is as full as a Track
  /// can be.
  tl::expected<void, FormatError> set(Time begin, Time end, const TactileMap &map);

  /// The known parts before `end`; the rest is silent.
  Track track(Time end, double rate) const;

private:
  using Map = std::optional<TactileMap>; ///< none: unknown

  std::map<Time, Map>::const_iterator find(Time time) const;

  TactileMap silent_;
  std::map<Time, Map> maps_; ///< each from its time to the next; the first is at 0
};

} // namespace tactile
