// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/felt_blocks.h"

#include <algorithm>

namespace tactor {

/// Times the level of the block: a block begins at once.
static constexpr float kStronger = 1.5F;

void
FeltBlocks::restart()
{
  grid_.restart();
}

void
FeltBlocks::silence()
{
  restart();
  std::ranges::fill(cells_, Cell{});
}

bool
FeltBlocks::take(const Map &map, double rate, bool on_grid)
{
  if (map.levels.size() != cells_.size()) {
    cells_.assign(map.levels.size(), {});
    grid_.restart();
  }
  const bool early = !map.at_once && !on_grid && rate > 0 && is_stronger(map.levels);
  if (!grid_.begins(map.time, map.duration, map.at_once ? 0 : rate, early))
    return false;
  for (std::size_t i = 0; i < cells_.size(); i++) {
    Cell &felt = cells_[i];
    const float level = map.levels[i] > 0 ? std::min(map.levels[i], 1.0F) : 0.0F; // NaN is 0
    const bool goes_on = early && felt.level > level
                         && std::chrono::duration<double>(map.time - felt.since).count() * rate < 1;
    if (!goes_on && felt.level != level)
      felt = { level, map.time };
  }
  return true;
}

void
FeltBlocks::carry(Time time, Time length)
{
  grid_.carry(time, length);
}

bool
FeltBlocks::is_stronger(std::span<const float> levels) const
{
  for (std::size_t i = 0; i < levels.size(); i++)
    if (std::min(levels[i], 1.0F) > kStronger * cells_[i].level)
      return true;
  return false;
}

} // namespace tactor
