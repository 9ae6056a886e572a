// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/cue_limiter.h"
#include "tracks/track.h"

#include <vector>

/// What a designer does to a track. Each operation makes a new track; rates stay. An event is a
/// stretch of time in which one cell is felt, whatever its level. What may make a track longer, or
/// have more changes or cells, fails where that is more than a track can be.
namespace tactile {

/// Two maps as one.
enum class Mix
{
  replace, ///< the second wherever it is felt at all, else the first
  max,     ///< cell by cell the stronger
};

/// Silences events that last less than `shortest`.
Track prune_short(const Track &track, Time shortest);

/// Silences events whose strongest level is below `weakest`.
Track prune_weak(const Track &track, float weakest);

/// Maps that differ by at most `tolerance` in every cell from the one before become that one.
Track merge_equal(const Track &track, float tolerance);

/// Ends events that last longer than `limits.max_duration` and keeps pauses of `limits.refractory`
/// between them, as CueLimiter does in the film, to 10 ms.
tl::expected<Track, FormatError> limit_events(const Track &track, const CueLimits &limits);

/// Everything later by `offset`, or earlier if that is negative: what would be before 0 is lost.
tl::expected<Track, FormatError> shift(const Track &track, Time offset);

/// Levels times `factor` ≥ 0, at most 1.
Track scale(const Track &track, float factor);

/// What is in [begin, end), which then begins at 0.
tl::expected<Track, FormatError> clip(const Track &track, Time begin, Time end);

/// Silence in [begin, end).
tl::expected<Track, FormatError> silence(const Track &track, Time begin, Time end);

/// Silences cells, numbered row by row from 0. Others are ignored.
Track mask(const Track &track, const std::vector<int> &cells);

/// Levels become multiples of 1 / steps, steps ≥ 1.
Track quantise(const Track &track, int steps);

/// On another grid over the same picture: a cell's level is the mean over its area.
TactileMap resample(const TactileMap &map, int rows, int columns);
tl::expected<Track, FormatError> resample(const Track &track, int rows, int columns);

/// Cell by cell, or one map instead of the other. `over` is resampled to the grid of `map` if need
/// be.
void mix_into(TactileMap &map, const TactileMap &over, Mix mix);

/// A second track over the first, on the first one's grid; as long as the longer one.
tl::expected<Track, FormatError> overlay(const Track &track, const Track &over, Mix mix);

/// A stretch of time in which two tracks differ in the same cells' levels throughout.
struct Difference
{
  Time begin{ 0 };
  Time end{ 0 };
  TactileMap before;
  TactileMap after;
};

/// Where `after` differs from `before` by more than `tolerance` in any cell, in order; an error if
/// the grids differ. Tracks of different lengths differ only where one of them is felt.
tl::expected<std::vector<Difference>, FormatError> diff(const Track &before, const Track &after,
                                                        float tolerance = 0);

} // namespace tactile
