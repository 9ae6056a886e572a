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

/// What runs on an emulated board: StandardFirmata, or with `seat` the sketch with the watchdog. It
/// remembers what its pins did, and when.
class Firmware
{
public:
  explicit Firmware(const Layout &layout = kMega, bool seat = false) : model_(layout, seat)
  {
  }

  /// The board was reset; what it says.
  Bytes reset()
  {
    const Clock::time_point now = Clock::now();
    model_.restart(now.time_since_epoch());
    return after(now);
  }
  /// A byte came; the answer.
  Bytes receive(std::uint8_t byte, Clock::time_point time)
  {
    model_.receive(byte, time.time_since_epoch());
    return after(time);
  }
  /// When it does something by itself, if no byte comes before.
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

  /// Of 255: what the pin's compare register holds.
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
  std::map<int, int> duties_; ///< as of the last look
  std::vector<Change> changes_;
};

} // namespace usb_test
