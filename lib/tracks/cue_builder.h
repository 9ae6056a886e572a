// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"
#include "tactile/time.h"

#include <deque>
#include <optional>

namespace tactile {

/// A map with an explicit end, as subtitles have.
struct Cue
{
  Time begin{ 0 };
  Time end{ 0 };
  TactileMap map;

  bool operator==(const Cue &) const = default;
};

/// Makes cues of a stream of maps: a new one where the map changes and at least every kLongest, so
/// that who joins late, seeks or loses one soon knows the state. Not thread-safe: one thread at a
/// time.
class CueBuilder
{
public:
  static constexpr Time kLongest = std::chrono::seconds(1);

  /// A break that is no longer comes from rounded times: the map before it lasts until the next.
  static constexpr Time kSeam = std::chrono::milliseconds(2);

  /// The map that holds in [begin, end). Where that is before the end of what was added, as it is
  /// with rounded times, the later one counts.
  void add(Time begin, Time end, const TactileMap &map);

  /// Nothing is known from now on (a gap, the end): what is left becomes cues.
  void flush();

  /// The next cue that is complete, in order of time.
  std::optional<Cue> take();

  /// Forgets all, as after a seek.
  void reset();

private:
  std::optional<Cue> open_; ///< the present map; its end may move on
  std::deque<Cue> complete_;
};

} // namespace tactile
