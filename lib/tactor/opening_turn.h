// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stop_token>

namespace tactor {

/// A place in this process's line of those who open a board. Who names no board takes the first
/// that is free: one at a time, in the order in which they came, so that each play finds the same
/// boards.
class OpeningTurn
{
public:
  /// The last place.
  OpeningTurn();
  /// The next one's turn.
  ~OpeningTurn();
  OpeningTurn(const OpeningTurn &) = delete;
  OpeningTurn &operator=(const OpeningTurn &) = delete;

  /// Waits for all that came before. False if `stop` was requested first.
  bool wait(const std::stop_token &stop) const;

private:
  const unsigned long place_;
};

} // namespace tactor
