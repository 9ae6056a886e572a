// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stop_token>

namespace tactor {

/// A place in this process's queue for opening boards. A sink that names no board takes the first
/// free one: sinks that open one at a time, in a fixed order, get the same boards in each play.
class OpeningTurn
{
public:
  /// Joins at the end of the queue.
  OpeningTurn();
  /// Leaves the queue.
  ~OpeningTurn();
  OpeningTurn(const OpeningTurn &) = delete;
  OpeningTurn &operator=(const OpeningTurn &) = delete;

  /// Waits until all that joined before have left. False if `stop` was requested first.
  bool wait(const std::stop_token &stop) const;

private:
  const unsigned long place_;
};

} // namespace tactor
