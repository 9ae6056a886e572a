// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"
#include "tactile/tactile_map.h"

#include <array>
#include <span>

namespace sound {

/// The place of a sound.
struct Place
{
  double across = 0;     ///< −1: left, 1: right
  double behind = 0;     ///< 0: in front, 1: behind
  double everywhere = 1; ///< the share of the sound without a place

  bool operator==(const Place &) const = default;
};

/// The place of a sound that has these powers in the speakers. `likeness`: see BandPowers.
Place place_of(std::span<const Speaker> speakers, std::span<const double> powers, double likeness);

/// Raises the cells of `map` at `place` to `level`: columns from left to right, rows from the front
/// (top) to what is behind. All rows without `has_rear`.
void raise(tactile::TactileMap &map, const Place &place, bool has_rear, float level);

bool has_rear(std::span<const Speaker> speakers);

} // namespace sound
