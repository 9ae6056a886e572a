// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

namespace tactile {

/// How two maps are combined.
enum class Mix
{
  replace, ///< the second wherever any of its cells is above 0, else the first
  max,     ///< the larger level of each cell
  sum,     ///< the sum of both levels, at most 1
  /// The second's strength at the first's place: the first map, scaled so that its largest level is
  /// that of the second. Silent while the second is; the second where the first has no place.
  gate,
  /// The first, and while the second is stronger, with its strength; the second where the first has
  /// no place.
  accent,
  stress, ///< as accent, but silent where the first has no place
};

/// As in `tactilecombiner mix=gate`.
const char *name_of(Mix mix);

/// Whether all levels are 0.
bool is_silent(const TactileMap &map);

/// Resamples to another grid over the same picture: a cell's level is the mean over its area.
TactileMap resample(const TactileMap &map, int rows, int columns);

/// Combines `over` into `map`; `over` is resampled to the grid of `map` if needed. The frequency is
/// that of the stronger.
void mix_into(TactileMap &map, const TactileMap &over, Mix mix);

} // namespace tactile
