// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/orientation.h"

#include <cstddef>

namespace tactile {

namespace {

/// Calls `pair(shown row, shown column, stored row, stored column)` for each cell.
template <typename Pair>
void
for_each_cell(int shown_rows, int shown_columns, Orientation orientation, const Pair &pair)
{
  const int stored_rows = orientation.transposed ? shown_columns : shown_rows;
  const int stored_columns = orientation.transposed ? shown_rows : shown_columns;
  for (int row = 0; row < shown_rows; ++row)
    for (int column = 0; column < shown_columns; ++column) {
      const int y = orientation.transposed ? column : row;
      const int x = orientation.transposed ? row : column;
      pair(row, column, orientation.mirrored_rows ? stored_rows - 1 - y : y,
           orientation.mirrored_columns ? stored_columns - 1 - x : x);
    }
}

/// Gives `map` this grid; its levels are undefined.
void
set_grid(TactileMap &map, int rows, int columns)
{
  map.rows = rows;
  map.columns = columns;
  map.levels.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
}

} // namespace

void
turn(const TactileMap &stored, Orientation orientation, TactileMap &shown)
{
  set_grid(shown, orientation.transposed ? stored.columns : stored.rows,
           orientation.transposed ? stored.rows : stored.columns);
  for_each_cell(shown.rows, shown.columns, orientation, [&](int row, int column, int y, int x) {
    shown.at(row, column) = stored.at(y, x);
  });
}

void
turn_back(const TactileMap &shown, Orientation orientation, TactileMap &stored)
{
  set_grid(stored, orientation.transposed ? shown.columns : shown.rows,
           orientation.transposed ? shown.rows : shown.columns);
  for_each_cell(shown.rows, shown.columns, orientation, [&](int row, int column, int y, int x) {
    stored.at(y, x) = shown.at(row, column);
  });
}

} // namespace tactile
