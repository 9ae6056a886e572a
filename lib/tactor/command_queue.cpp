// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_queue.h"

#include <algorithm>

namespace tactor {

CommandQueue::CommandQueue(int tactors)
    : levels_(static_cast<std::size_t>(std::max(tactors, 0)), 0.0),
      until_(levels_.size(), Time::max())
{
}

void
CommandQueue::push(std::span<const Command> commands)
{
  for (const Command &command : commands) {
    if (command.tactor < 0 || static_cast<std::size_t>(command.tactor) >= levels_.size())
      continue;
    const auto tactor = static_cast<std::size_t>(command.tactor);
    if (command.volts == 0 && levels_[tactor] == 0 && command.due() == until_[tactor])
      continue;
    const auto place = std::ranges::upper_bound(commands_, command.due(), {}, &Command::due);
    commands_.insert(place, command);
  }
}

std::optional<Time>
CommandQueue::next_due() const
{
  Time next = commands_.empty() ? Time::max() : commands_.front().due();
  for (std::size_t i = 0; i < levels_.size(); i++)
    if (levels_[i] != 0)
      next = std::min(next, until_[i]);
  if (next == Time::max())
    return std::nullopt;
  return next;
}

std::vector<Command>
CommandQueue::take_due(Time now)
{
  const auto end = std::ranges::upper_bound(commands_, now, {}, &Command::due);
  std::vector<Command> due;
  for (auto command = commands_.begin(); command != end; ++command) {
    // Latest wins: an earlier one for the same tactor has no effect.
    const bool overtaken = std::any_of(
        command + 1, end, [&](const Command &later) { return later.tactor == command->tactor; });
    if (overtaken) {
      coalesced_++;
      continue;
    }
    levels_[static_cast<std::size_t>(command->tactor)] = command->volts;
    until_[static_cast<std::size_t>(command->tactor)] = command->until;
    due.push_back(*command);
  }
  commands_.erase(commands_.begin(), end);
  for (std::size_t i = 0; i < levels_.size(); i++) {
    if (levels_[i] == 0 || until_[i] > now || until_[i] == Time::max())
      continue;
    const auto tactor = static_cast<int>(i);
    std::erase_if(due, [&](const Command &command) { return command.tactor == tactor; });
    due.push_back({ .effect = until_[i], .lead = Time(0), .tactor = tactor, .volts = 0 });
    levels_[i] = 0;
  }
  std::ranges::stable_sort(due, {}, &Command::due);
  return due;
}

std::size_t
CommandQueue::drop_due(Time now, std::optional<Command> &earliest)
{
  const auto end = std::ranges::upper_bound(commands_, now, {}, &Command::due);
  if (end != commands_.begin())
    earliest = commands_.front();
  const auto dropped = static_cast<std::size_t>(end - commands_.begin());
  commands_.erase(commands_.begin(), end);
  return dropped;
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
  std::ranges::fill(until_, Time::max());
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
