// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/cue_limiter.h"
#include "tactile/mix.h"
#include "tracks/track.h"

#include <vector>

/// Editing operations on tracks. Each returns a new track; the rate is kept. An event is a stretch
/// of time in which a cell's level is above 0. Operations that could exceed the limits of Track
/// return an error then.
namespace tactile {

/// Silences events shorter than `shortest`.
Track prune_short(const Track &track, Time shortest);

/// Silences events whose highest level is below `weakest`.
Track prune_weak(const Track &track, float weakest);

/// Replaces each map that differs from the one before by at most `tolerance` in every cell.
Track merge_equal(const Track &track, float tolerance);

/// Ends events after `limits.max_duration` and keeps breaks of `limits.refractory` between them, as
/// CueLimiter does during playback, to within 10 ms.
tl::expected<Track, FormatError> limit_events(const Track &track, const CueLimits &limits);

/// Moves the track by `offset`, which may be negative; what would be before 0 is lost.
tl::expected<Track, FormatError> shift(const Track &track, Time offset);

/// Multiplies levels by `factor` ≥ 0; limited to 1.
Track scale(const Track &track, float factor);

/// The part in [begin, end), moved to 0.
tl::expected<Track, FormatError> clip(const Track &track, Time begin, Time end);

/// Silences [begin, end).
tl::expected<Track, FormatError> silence(const Track &track, Time begin, Time end);

/// Gives each map a frequency in Hz; 0: none.
Track tune(const Track &track, float frequency);

/// Silences these cells, row-major from 0; other indices are ignored.
Track mask(const Track &track, const std::vector<int> &cells);

/// Rounds levels to multiples of 1 / steps, steps ≥ 1.
Track quantize(const Track &track, int steps);

/// As resample() of a map.
tl::expected<Track, FormatError> resample(const Track &track, int rows, int columns);

/// Combines two tracks on the grid of the first; as long as the longer one.
tl::expected<Track, FormatError> overlay(const Track &track, const Track &over, Mix mix);

/// Takes `by` in [begin, end) for these cells, row-major from 0; none: for all. Fails if the grids
/// differ.
tl::expected<Track, FormatError> replace(const Track &track, const Track &by, Time begin, Time end,
                                         const std::vector<int> &cells);

/// A stretch of time in which the same cells differ between two tracks.
struct Difference
{
  Time begin{ 0 };
  Time end{ 0 };
  TactileMap before;
  TactileMap after;
};

/// Whether the frequencies are the same; with any tolerance, within half a hertz.
bool is_same_frequency(const TactileMap &a, const TactileMap &b, float tolerance);

/// Lists where `after` differs from `before`, in order of time: by more than `tolerance` in any
/// cell, or by the frequency. Fails if the grids differ. Beyond the end of a track all its levels
/// are 0.
tl::expected<std::vector<Difference>, FormatError> diff(const Track &before, const Track &after,
                                                        float tolerance = 0);

} // namespace tactile
