// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/firmware.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

namespace usb_test {

struct Received
{
  Clock::time_point time; ///< its stop bit's end on the wire
  std::uint8_t byte = 0;
};

/// What stands between a board's USB endpoint and its serial line: it takes bytes at once, as far
/// as it has room, and lets them out as the line carries them. Not thread-safe.
class SerialChip
{
public:
  /// `latency` from when a byte is taken to when the line begins with it. A line of 0 baud takes no
  /// time.
  SerialChip(std::size_t room, double baud, std::chrono::microseconds latency);

  bool has_room_for(std::size_t bytes) const
  {
    return held_.size() + bytes <= room_;
  }
  void take(std::span<const std::uint8_t> bytes, Clock::time_point now);

  /// When the next byte has left.
  std::optional<Clock::time_point> next() const;
  /// One that has left by now.
  std::optional<Received> let_out(Clock::time_point now);

  /// Its line is switched off and on. What would have left later arrives garbled, here not at all.
  void switch_line(Clock::time_point time);
  void lose_power()
  {
    held_.clear();
  }

  Clock::duration byte_time() const
  {
    return byte_time_;
  }
  /// Bytes that it has taken and not let out.
  std::size_t held() const
  {
    return held_.size();
  }
  /// Bytes that it had taken and that never left.
  std::size_t cut_off() const
  {
    return cut_off_;
  }

private:
  const std::size_t room_;
  const Clock::duration byte_time_;
  const Clock::duration latency_;
  std::deque<Received> held_;
  Clock::time_point line_free_{};
  std::size_t cut_off_ = 0;
};

} // namespace usb_test
