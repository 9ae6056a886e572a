// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/firmata_model.h"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace usb_test {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

/// The firmware of an emulated board: StandardFirmata, or with `seat` the sketch with the watchdog.
/// Records the changes of its pins.
class Firmware
{
public:
  explicit Firmware(const Layout &layout = kMega, bool seat = false) : model_(layout, seat)
  {
  }

  /// Resets the board and returns its banner.
  Bytes reset()
  {
    const Clock::time_point now = Clock::now();
    model_.restart(now.time_since_epoch());
    return after(now);
  }
  /// Handles a byte and returns the answer.
  Bytes receive(std::uint8_t byte, Clock::time_point time)
  {
    model_.receive(byte, time.time_since_epoch());
    return after(time);
  }
  /// When it next acts without input.
  std::optional<Clock::time_point> next() const
  {
    const std::optional<FirmataModel::Time> time = model_.next();
    return time ? std::optional(Clock::time_point(*time)) : std::nullopt;
  }
  void pass(Clock::time_point time)
  {
    model_.pass(time.time_since_epoch());
    after(time);
  }

  struct Change
  {
    Clock::time_point time;
    int pin = 0;
    int duty = 0; ///< of 255
  };

  /// The pin's compare register, of 255.
  int duty(int pin) const
  {
    const auto found = duties_.find(pin);
    return found == duties_.end() ? 0 : found->second;
  }
  bool any_motor_on() const
  {
    return !model_.is_silent();
  }
  const std::vector<Change> &changes() const
  {
    return changes_;
  }
  int resets() const ///< by FF
  {
    return model_.resets;
  }
  int keepalives() const
  {
    return model_.keepalives;
  }

private:
  Bytes after(Clock::time_point now)
  {
    for (const auto &[pin, duty] : duties_)
      if (duty != 0 && !model_.duty.contains(pin))
        changes_.push_back({ now, pin, 0 });
    for (const auto &[pin, duty] : model_.duty)
      if (duty != this->duty(pin))
        changes_.push_back({ now, pin, duty });
    duties_ = model_.duty;
    const Bytes said(model_.replies.begin(), model_.replies.end());
    model_.replies.clear();
    return said;
  }

  FirmataModel model_;
  std::map<int, int> duties_; ///< at the last call of after()
  std::vector<Change> changes_;
};

} // namespace usb_test
