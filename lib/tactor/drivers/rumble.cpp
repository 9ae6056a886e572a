// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/rumble.h"

namespace tactor {

Time
shortest_interval(const Gamepad &gamepad)
{
  constexpr int kMicrosoft = 0x045e;
  return gamepad.is_bluetooth && gamepad.vendor == kMicrosoft ? std::chrono::milliseconds(50)
                                                              : std::chrono::milliseconds(10);
}

Rumble::Rumble(Time interval, RumbleTimes times) : interval_(interval), times_(times)
{
}

void
Rumble::set(const GamepadLevels &levels)
{
  wanted_ = levels;
  is_set_ = true;
}

std::optional<GamepadLevels>
Rumble::next(Time now)
{
  const std::optional<Time> due = deadline();
  if (!due || now < *due)
    return std::nullopt;
  sent_ = wanted_;
  sent_at_ = now;
  is_set_ = false;
  return sent_;
}

std::optional<Time>
Rumble::deadline() const
{
  if (!sent_at_)
    return Time::min(); // motors to zero, whatever they did before
  if (wanted_ != sent_)
    return *sent_at_ + interval_;
  if (is_set_ && is_on())
    return *sent_at_ + times_.renewal;
  return std::nullopt;
}

bool
Rumble::is_on() const
{
  return wanted_ != GamepadLevels{} || sent_ != GamepadLevels{};
}

} // namespace tactor
