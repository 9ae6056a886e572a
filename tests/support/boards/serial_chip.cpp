// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/serial_chip.h"

#include <algorithm>

namespace usb_test {

namespace {

constexpr int kBitsPerByte = 10; // 8N1

} // namespace

SerialChip::SerialChip(std::size_t room, double baud, std::chrono::microseconds latency)
    : room_(room), byte_time_(std::chrono::duration_cast<Clock::duration>(
                       std::chrono::duration<double>(baud > 0 ? kBitsPerByte / baud : 0.0))),
      latency_(latency)
{
}

void
SerialChip::take(std::span<const std::uint8_t> bytes, Clock::time_point now)
{
  line_free_ = std::max(now + latency_, line_free_);
  for (const std::uint8_t byte : bytes)
    held_.push_back({ line_free_ += byte_time_, byte });
}

std::optional<Clock::time_point>
SerialChip::next() const
{
  return held_.empty() ? std::nullopt : std::optional(held_.front().time);
}

std::optional<Received>
SerialChip::let_out(Clock::time_point now)
{
  if (held_.empty() || held_.front().time > now)
    return std::nullopt;
  const Received first = held_.front();
  held_.pop_front();
  return first;
}

void
SerialChip::switch_line(Clock::time_point time)
{
  cut_off_ += std::erase_if(held_, [time](const Received &one) { return one.time > time; });
}

} // namespace usb_test
