// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/gamepads.h"

#include <optional>

namespace tactor {

struct RumbleTimes
{
  /// Duration of each rumble: how long motors run after the last write().
  Time duration = std::chrono::milliseconds(250);
  /// Levels that are written again are sent again after this time.
  Time renewal = std::chrono::milliseconds(100);
  /// How often write() is to be called while a motor is on.
  Time refresh = std::chrono::milliseconds(80);
};

/// The shortest time between two rumbles. SDL sends one every 10 ms; an Xbox gamepad by Bluetooth
/// falls behind and drops its connection with more than one in 50 ms (SDL issue 6435, xpadneo
/// issue 487).
Time shortest_interval(const Gamepad &gamepad);

/// When a gamepad is sent which levels: the newest ones, not faster than its connection bears, and
/// again before their duration ends as long as set() is called. Times are of any one clock. Not
/// thread-safe.
class Rumble
{
public:
  explicit Rumble(Time interval, RumbleTimes times = {});

  void set(const GamepadLevels &levels);

  /// The levels to send now, if any; they count as sent.
  std::optional<GamepadLevels> next(Time now);

  /// When next() has levels; none before the next set().
  std::optional<Time> deadline() const;

  bool is_on() const;

private:
  Time interval_;
  RumbleTimes times_;
  GamepadLevels wanted_{};
  GamepadLevels sent_{};
  std::optional<Time> sent_at_;
  bool is_set_ = true; ///< since sent_at_
};

} // namespace tactor
