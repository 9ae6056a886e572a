// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/tactile_map.h"
#include "tracks/track.h"

#include <deque>
#include <optional>

namespace tactile {

/// A map with an explicit end, like a subtitle.
struct Cue
{
  Time begin{ 0 };
  Time end{ 0 };
  TactileMap map;

  bool operator==(const Cue &) const = default;
};

/// Makes cues from a stream of maps: a new one when the map changes and at least every kLongest. A
/// receiver thus knows the state soon after joining, seeking or losing a cue. Not thread-safe.
class CueBuilder
{
public:
  static constexpr Time kLongest = std::chrono::seconds(1);

  /// Shorter gaps are rounding errors of timestamps: the map before one is extended to the next.
  static constexpr Time kSeam = std::chrono::milliseconds(2);

  /// Adds the map of [begin, end). If begin is before the end of the last map, because of rounded
  /// timestamps, the later map wins.
  void add(Time begin, Time end, const TactileMap &map);

  /// Ends the current map, for a gap or the end of stream: what is left becomes cues.
  void flush();

  /// The next complete cue in order of time, if any.
  std::optional<Cue> take();

  /// Drops everything, for a seek.
  void reset();

private:
  std::optional<Cue> open_; ///< the current map; its end may still change
  std::deque<Cue> complete_;
};

/// A whole track as cues from 0 to its end, silent ones too.
std::deque<Cue> cues_of(const Track &track);

} // namespace tactile
