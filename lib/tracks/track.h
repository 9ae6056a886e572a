// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/mix.h"
#include "tactile/tactile_map.h"
#include "tracks/format_error.h"

#include <cstddef>
#include <vector>

namespace tactile {

/// A film's tactile maps over time. Each is valid until the next, the last one until end(); before
/// 0 and from end() on all levels are 0.
///
/// The representation is unique: a track begins with a map at 0, a silent one by default; times
/// increase, adjacent maps differ, silent ones have no frequency, and all times are before end(). A
/// value type: threads may share one that none of them changes.
class Track
{
public:
  struct Entry
  {
    Time time;
    TactileMap map;

    bool operator==(const Entry &) const = default;
  };

  /// Limit on the duration: longer than any film.
  static constexpr Time kMaxEnd = std::chrono::hours(100);
  /// Limits on the size: a reader needs at most 512 MiB for the levels.
  static constexpr std::size_t kMaxEntries = 4'000'000;
  static constexpr std::size_t kMaxLevels = std::size_t{ 1 } << 27;

  /// A silent track of length 0. Rows and columns are clamped to [kMinGridSide, kMaxGridSide].
  explicit Track(int rows = 3, int columns = 3);

  int rows() const;
  int columns() const;

  /// Maps per second for which the track was authored (tactorsink's rate); 0: unknown, or every
  /// frame.
  double rate() const;
  void set_rate(double rate);

  /// In order of time; never empty, the first is at 0.
  const std::vector<Entry> &entries() const;

  /// End of the track; never before the last entry.
  Time end() const;

  /// Sets the map from `time` on, and replaces one appended for the same time. Fails and leaves the
  /// track unchanged if `time` is before the last entry, negative or beyond kMaxEnd, if the map has
  /// another grid, or if the track is full.
  tl::expected<void, FormatError> append(Time time, const TactileMap &map);

  /// Sets the end of the track and drops what was appended from there on. Fails if `end` is
  /// negative or beyond kMaxEnd.
  tl::expected<void, FormatError> set_end(Time end);

  /// The map at `time`; a silent one outside [0, end()).
  const TactileMap &at(Time time) const;

  bool operator==(const Track &) const = default;

private:
  std::size_t index_at(Time time) const;

  TactileMap silent_;
  double rate_ = 0;
  std::vector<Entry> entries_;
  Time end_{ 0 };
};

/// Whether a map of the track has one.
bool has_frequency(const Track &track);

/// The track as a format can store it. Times are rounded down to multiples of `tick`, so that no
/// cue begins after its frame. Levels are rounded to multiples of 1 / `steps`, frequencies to whole
/// Hz (0: unchanged). Maps shorter than a tick are lost.
Track at_resolution(const Track &track, Time tick, int steps);

} // namespace tactile
