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
  Clock::time_point time; ///< end of its stop bit
  std::uint8_t byte = 0;
};

/// The UART between a board's USB endpoint and its firmware, with a transmit buffer. Not
/// thread-safe.
class SerialChip
{
public:
  /// `latency` is the time from a byte's arrival to its start on the line. At 0 baud a byte takes
  /// no time.
  SerialChip(std::size_t room, double baud, std::chrono::microseconds latency);

  bool has_room_for(std::size_t bytes) const
  {
    return held_.size() + bytes <= room_;
  }
  void take(std::span<const std::uint8_t> bytes, Clock::time_point now);

  /// When the next byte will have left.
  std::optional<Clock::time_point> next() const;
  /// Takes a byte that has left.
  std::optional<Received> let_out(Clock::time_point now);

  /// Resets the line. Bytes in the buffer would arrive garbled; here they are lost.
  void switch_line(Clock::time_point time);
  void lose_power()
  {
    held_.clear();
  }

  Clock::duration byte_time() const
  {
    return byte_time_;
  }
  /// Bytes in the buffer.
  std::size_t held() const
  {
    return held_.size();
  }
  /// Bytes lost by reset().
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
