// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command.h"

#include <optional>
#include <span>
#include <vector>

namespace tactor {

/// Planned commands in order of their due time, and what every motor was told last. Not
/// thread-safe: its owner guards it.
class CommandQueue
{
public:
  explicit CommandQueue(int tactors);

  void push(std::span<const Command> commands);

  /// When something is to be done next, if ever: a command is due or one that was taken runs out
  /// (Command::until).
  std::optional<Time> next_due() const;

  /// Takes all commands due at or before `now`, in order of due time. Commands for the same tactor
  /// coalesce: only the latest is returned, `coalesced()` counts the others. For one that has run
  /// out by then a zero is returned, due when it did; if that zero is pushed later, it is ignored.
  /// levels() is up to date afterwards.
  std::vector<Command> take_due(Time now);

  /// Volts of all tactors after the commands taken so far: what a resume after pause reissues.
  std::span<const double> levels() const;

  /// Drops everything and sets all levels to zero (flush, stop). Returns how many commands were
  /// dropped.
  std::size_t clear();

  std::size_t size() const;      ///< commands that are not due yet
  std::size_t coalesced() const; ///< since construction

private:
  std::vector<Command> commands_; ///< by due time; those of the same time in order of arrival
  std::vector<double> levels_;
  std::vector<Time> until_; ///< of the command that made the level
  std::size_t coalesced_ = 0;
};

} // namespace tactor
