// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace tactile {

/// Joins curves of level over time, each on one channel, to a track. A channel plays on cells.
///
/// Curves are linear between their points: a slope becomes steps of 20 ms at their mean level, and
/// is a step at its beginning if it takes at most one step length. Curves that overlap on a channel
/// are added, as are channels on a cell; sums end at 1.
class LevelCurves
{
public:
  struct Point
  {
    std::int64_t position; ///< ticks
    double level;          ///< 0 and more
  };

  /// Limit on the curves that overlap on one channel.
  static constexpr std::size_t kMostAtOnce = 1000;

  /// Limit on the changes times the channels and cells.
  static constexpr std::size_t kMostJoined = std::size_t{ 1 } << 30;

  /// @param ticks_per_second 1 to 1,000,000 @param step_length in ticks
  LevelCurves(double ticks_per_second, std::int64_t step_length);

  /// The latest position of a point, Track::kMaxEnd in ticks.
  double latest() const;

  /// Adds a curve. It begins at the first point and ends at the last, with a level that holds for
  /// no time; a last step ends it at once. Positions must not decrease. Fails for a time outside
  /// [0, Track::kMaxEnd] and beyond Track::kMaxEntries changes.
  tl::expected<void, FormatError> add(std::size_t channel, std::span<const Point> points);

  /// Sets the frequency from one point to another, whose `level` is one in Hz; 0: none. It is
  /// linear between them, in steps of 20 ms. Later calls win. Fails beyond Track::kMaxEntries steps
  /// of all calls.
  tl::expected<void, FormatError> set_frequency(const Point &from, const Point &to);

  /// Whether a later call changed a frequency by 1 Hz or more.
  bool has_lost_frequency() const
  {
    return has_lost_frequency_;
  }

  /// The track, once. Its grid must have each cell of `cells`, which has the cells of each channel.
  /// It ends where the last curve does. Fails beyond kMostJoined.
  tl::expected<Track, FormatError> join(Track track,
                                        std::span<const std::vector<std::size_t>> cells);
  /// The track of channel 0 as one cell.
  tl::expected<Track, FormatError> join();

private:
  /// A new level of one curve.
  struct Change
  {
    Time time;
    std::size_t channel;
    std::size_t curve;
    double level;
  };

  Time time_of(std::int64_t position) const;
  void change(std::int64_t position, std::size_t channel, double level);
  bool has_other_frequency(Time begin, Time end, double frequency) const;

  double ticks_per_second_;
  std::int64_t step_length_;
  std::size_t curves_ = 0;
  std::vector<Change> changes_;
  std::map<Time, float> frequencies_; ///< each from its time to the next
  std::size_t tuned_ = 0;             ///< steps, also those that later calls replaced
  bool has_lost_frequency_ = false;
};

} // namespace tactile
