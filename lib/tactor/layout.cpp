// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/layout.h"

#include <algorithm>

namespace tactor {

bool
pools(const Layout &layout, int rows, int columns)
{
  return rows > layout.rows || columns > layout.columns;
}

int
most_tactors_of_cell(const Layout &layout, int rows, int columns)
{
  const auto shares = [](int tactors, int cells) {
    return std::max((tactors + cells - 1) / cells, 1);
  };
  return shares(layout.rows, rows) * shares(layout.columns, columns) * layout.panels;
}

void
pool(std::span<const float> levels, int rows, int columns, const Layout &layout,
     std::vector<float> &pooled)
{
  pooled.assign(static_cast<std::size_t>(layout.tactors()), 0);
  // Both grids are walked in the steps of the finer one.
  const int down = std::max(rows, layout.rows);
  const int across = std::max(columns, layout.columns);
  const auto panel = static_cast<std::size_t>(layout.rows * layout.columns);
  for (int y = 0; y < down; y++)
    for (int x = 0; x < across; x++) {
      const int cell = y * rows / down * columns + x * columns / across;
      const int tactor = y * layout.rows / down * layout.columns + x * layout.columns / across;
      const float level = levels[static_cast<std::size_t>(cell)];
      for (auto i = static_cast<std::size_t>(tactor); i < pooled.size(); i += panel)
        pooled[i] = std::max(pooled[i], level);
    }
}

} // namespace tactor
