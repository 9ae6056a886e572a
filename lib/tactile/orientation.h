// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

namespace tactile {

/// How a picture is turned between its pixels as they are stored and the screen: sample (row,
/// column) of what is shown is sample (column, row) of what is stored if it is transposed, (row,
/// column) if not, counted from the other end along each axis that is mirrored.
struct Orientation
{
  bool transposed = false;
  bool mirrored_rows = false;    ///< stored rows are counted from the bottom
  bool mirrored_columns = false; ///< stored columns are counted from the right

  bool operator==(const Orientation &) const = default;
};

/// A map of the stored picture as it is on the screen. Allocates only for a larger grid.
void turn(const TactileMap &stored, Orientation orientation, TactileMap &shown);

/// The opposite: a map of the screen as it lies on the stored picture.
void turn_back(const TactileMap &shown, Orientation orientation, TactileMap &stored);

} // namespace tactile
