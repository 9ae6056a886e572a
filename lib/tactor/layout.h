// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

namespace tactor {

/// How the tactors of a device stand: panels of rows × columns, such as the back and the front of a
/// vest. Each panel has the whole map. Tactor 0 is the top left one of the first panel as seen on
/// the screen; they go on row by row, then panel by panel. Tactors beyond have no place.
struct Layout
{
  int rows = 0; ///< 0: the tactors have no places
  int columns = 0;
  int panels = 1;
  bool operator==(const Layout &) const = default;

  int tactors() const
  {
    return rows * columns * panels;
  }
};

/// Whether a tactor of the layout stands for several cells of a map.
bool pools(const Layout &layout, int rows, int columns);

/// The most tactors that stand for one cell of a map, at least 1.
int most_tactors_of_cell(const Layout &layout, int rows, int columns);

/// The levels of the layout's tactors. Where the map is finer, a tactor has the strongest of its
/// cells, as many as its neighbors or one less; what is left over goes to the left and to the top.
/// Where it is coarser, neighboring tactors share a cell. No cell is dropped.
void pool(std::span<const float> levels, int rows, int columns, const Layout &layout,
          std::vector<float> &pooled);

} // namespace tactor
