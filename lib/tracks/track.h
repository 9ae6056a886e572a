// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"
#include "tactile/time.h"
#include "tracks/format_error.h"

#include <cstddef>
#include <vector>

namespace tactile {

/// A film's tactile maps: each holds until the next, the last until end(); before 0 and from end()
/// on all is silent.
///
/// There is one Track for one course of levels over time: it begins with a map at 0, a silent one
/// if nothing else was appended, its times increase, neighbors differ, and all are before end(). A
/// value: several threads may read one that none changes.
class Track
{
public:
  struct Entry
  {
    Time time;
    TactileMap map;

    bool operator==(const Entry &) const = default;
  };

  /// Tracks are not longer than any film.
  static constexpr Time kMaxEnd = std::chrono::hours(100);
  /// Nor larger than a reader can take: 512 MiB of levels.
  static constexpr std::size_t kMaxEntries = 4'000'000;
  static constexpr std::size_t kMaxLevels = std::size_t{ 1 } << 27;

  /// A silent track of length 0. Rows and columns are clamped to [kMinGridSide, kMaxGridSide].
  explicit Track(int rows = 3, int columns = 3);

  int rows() const;
  int columns() const;

  /// Blocks per second that the track was authored with (tactorsink's rate); 0: unknown, or every
  /// frame.
  double rate() const;
  void set_rate(double rate);

  /// At least one: the map at 0.
  const std::vector<Entry> &entries() const;

  /// Where the track ends; never before the last entry.
  Time end() const;

  /// What holds from `time` on; replaces what was appended for the same time. Refused, with the
  /// track as it was, if `time` is before the last one, negative or beyond kMaxEnd, if the map is
  /// of another grid, or if the track is full.
  tl::expected<void, FormatError> append(Time time, const TactileMap &map);

  /// The track ends at `end`: what was appended from there on is dropped. Refused likewise if `end`
  /// is negative or beyond kMaxEnd.
  tl::expected<void, FormatError> set_end(Time end);

  /// The map that holds at `time`; a silent one outside [0, end()).
  const TactileMap &at(Time time) const;

  bool operator==(const Track &) const = default;

private:
  std::size_t index_at(Time time) const;

  TactileMap silent_;
  double rate_ = 0;
  std::vector<Entry> entries_;
  Time end_{ 0 };
};

/// Whether no tactor is felt.
bool is_silent(const TactileMap &map);

/// What a format can hold of a track: times cut down to multiples of `tick` (a cue never begins
/// after its frame), levels rounded to multiples of 1 / `steps` (0: as they are). Maps shorter than
/// a tick are lost.
Track at_resolution(const Track &track, Time tick, int steps);

} // namespace tactile
