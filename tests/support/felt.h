// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

#include <cstddef>

/// A map of 3 × 3 with one cell on; none for −1.
inline tactile::TactileMap
felt(int cell)
{
  tactile::TactileMap map(3, 3);
  if (cell >= 0)
    map.levels[static_cast<std::size_t>(cell)] = 0.5F;
  return map;
}
