// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_queue.h"

#include <algorithm>

namespace tactor {

CommandQueue::CommandQueue(int tactors)
    : levels_(static_cast<std::size_t>(std::max(tactors, 0)), 0.0)
{
}

void
CommandQueue::push(std::span<const Command> commands)
{
  for (const Command &command : commands) {
    if (command.tactor < 0 || static_cast<std::size_t>(command.tactor) >= levels_.size())
      continue;
    const auto place = std::ranges::upper_bound(commands_, command.due(), {}, &Command::due);
    commands_.insert(place, command);
  }
}

std::optional<Time>
CommandQueue::next_due() const
{
  if (commands_.empty())
    return std::nullopt;
  return commands_.front().due();
}

std::vector<Command>
CommandQueue::take_due(Time now)
{
  const auto end = std::ranges::upper_bound(commands_, now, {}, &Command::due);
  std::vector<Command> due;
  for (auto command = commands_.begin(); command != end; ++command) {
    // The latest for its tactor, which is the only one that changes anything.
    const bool overtaken = std::any_of(
        command + 1, end, [&](const Command &later) { return later.tactor == command->tactor; });
    if (overtaken) {
      coalesced_++;
      continue;
    }
    levels_[static_cast<std::size_t>(command->tactor)] = command->volts;
    due.push_back(*command);
  }
  commands_.erase(commands_.begin(), end);
  return due;
}

std::span<const double>
CommandQueue::levels() const
{
  return levels_;
}

std::size_t
CommandQueue::clear()
{
  const std::size_t dropped = commands_.size();
  commands_.clear();
  std::ranges::fill(levels_, 0.0);
  return dropped;
}

std::size_t
CommandQueue::size() const
{
  return commands_.size();
}

std::size_t
CommandQueue::coalesced() const
{
  return coalesced_;
}

} // namespace tactor
