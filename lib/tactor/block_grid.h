// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <optional>

namespace tactor {

/// The blocks of 1 / rate in which maps are taken (paper, Section 2: the tactile buffers are read
/// at a lower rate).
///
/// A block begins with the first map of which more than half lies beyond the block's start on a
/// regular grid. The grid begins with the first map, and anew where time goes back or a whole block
/// passed without a map. It also begins anew, ahead of its time, with a map that is `stronger` than
/// the block. No block begins while the line carries the last one: a chair that is large for its
/// line gets fewer blocks, not late ones.
class BlockGrid
{
public:
  /// The next map begins a grid.
  void restart();

  /// Whether a block begins with the map of [time, time + duration). `rate` in blocks per second;
  /// 0: every map is a block.
  bool begins(Time time, Time duration, double rate, bool stronger = false);

  /// The line takes `length` for the block that began at `time`.
  void carry(Time time, Time length);

private:
  std::optional<Time> start_;
  double next_ = 0; ///< number of the next block
  Time carried_from_{ 0 };
  Time carried_until_{ 0 };
};

} // namespace tactor
