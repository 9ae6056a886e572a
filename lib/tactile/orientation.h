// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

namespace tactile {

/// Rotation and flip between stored pixels and the screen. Sample (row, column) on the screen is
/// stored sample (column, row) if transposed, else (row, column), counted from the opposite end
/// along each mirrored axis.
struct Orientation
{
  bool transposed = false;
  bool mirrored_rows = false;    ///< stored rows are counted from the bottom
  bool mirrored_columns = false; ///< stored columns are counted from the right

  bool operator==(const Orientation &) const = default;
};

/// Turns a map of the stored picture to the screen's orientation. Allocates only for a larger grid.
void turn(const TactileMap &stored, Orientation orientation, TactileMap &shown);

/// The inverse: from the screen's orientation to the stored picture's.
void turn_back(const TactileMap &shown, Orientation orientation, TactileMap &stored);

} // namespace tactile
