// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command.h"

#include <optional>
#include <span>
#include <vector>

namespace tactor {

/// Planned commands by due time, and the current level of every tactor. Not thread-safe.
class CommandQueue
{
public:
  explicit CommandQueue(int tactors);

  void push(std::span<const Command> commands);

  /// When a command is due or the level of one that was taken ends (Command::until), whichever is
  /// next.
  std::optional<Time> next_due() const;

  /// Takes all commands due at or before `now`, in order of due time, and updates levels().
  /// Commands for the same tactor coalesce: only the latest is returned, `coalesced()` counts the
  /// others. A level that has ended by then yields a zero, due when it ended; if that zero is
  /// pushed later, it is ignored.
  std::vector<Command> take_due(Time now);

  /// Volts of all tactors after the commands taken so far.
  std::span<const double> levels() const;

  /// Drops the commands due at or before `now`. Returns their number, and the earliest, if any.
  std::size_t drop_due(Time now, std::optional<Command> &earliest);

  /// Drops all commands and sets all levels to zero. Returns how many commands were dropped.
  std::size_t clear();

  std::size_t size() const;      ///< commands that are not due yet
  std::size_t coalesced() const; ///< since construction

private:
  std::vector<Command> commands_; ///< by due time; those of the same time in order of arrival
  std::vector<double> levels_;
  std::vector<Time> until_; ///< end of each level
  std::size_t coalesced_ = 0;
};

} // namespace tactor
