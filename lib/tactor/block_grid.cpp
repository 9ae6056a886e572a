// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/block_grid.h"

namespace tactor {

void
BlockGrid::restart()
{
  *this = {};
}

bool
BlockGrid::begins(Time time, Time duration, double rate, bool stronger)
{
  if (time >= carried_from_ && time < carried_until_)
    return false;
  if (rate <= 0)
    return true;
  if (!start_ || time < *start_ || stronger) {
    start_ = time;
    next_ = 1;
    return true;
  }
  // The middle of its frame: neither rounded timestamps nor a frame rate that is no multiple of the
  // block rate shift the grid.
  const double blocks = std::chrono::duration<double>(time - *start_ + duration / 2).count() * rate;
  if (blocks < next_)
    return false;
  if (blocks >= next_ + 1) {
    // The rest of this block may be too short to be felt.
    start_ = time;
    next_ = 1;
  } else {
    next_++;
  }
  return true;
}

void
BlockGrid::carry(Time time, Time length)
{
  carried_from_ = time;
  carried_until_ = time + length;
}

} // namespace tactor
