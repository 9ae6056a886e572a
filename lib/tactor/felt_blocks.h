// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/block_grid.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tactor {

/// The levels of each block of BlockGrid. A block has the levels of its first map. A map with a
/// cell that is stronger by half begins a block at once, so that a cue that begins in a silent cell
/// is neither lost nor late at any rate; cells that were not felt for a whole block yet continue in
/// it. Not thread-safe.
class FeltBlocks
{
public:
  struct Map
  {
    Time time;
    Time duration;
    std::span<const float> levels; ///< row-major in [0, 1]; others are clamped, NaN is 0
    bool at_once = false; ///< a block with its own levels alone, which leaves the grid as it is
  };

  /// The next map begins a grid.
  void restart();

  /// As restart(), and nothing is felt any more.
  void silence();

  /// Whether a block begins with the map. `rate` in blocks per second; 0: every map is a block.
  /// Another number of cells begins a grid. `on_grid` alone: no block begins ahead of its time, as
  /// in the paper.
  bool take(const Map &map, double rate, bool on_grid = false);

  /// See BlockGrid.
  void carry(Time time, Time length);

  std::size_t cells() const
  {
    return cells_.size();
  }
  /// The level of a cell in the present block.
  float level(std::size_t cell) const
  {
    return cells_[cell].level;
  }

private:
  struct Cell
  {
    float level = 0;
    Time since{ 0 };
  };

  bool is_stronger(std::span<const float> levels) const;

  BlockGrid grid_;
  std::vector<Cell> cells_; ///< as many as the last map has
};

} // namespace tactor
