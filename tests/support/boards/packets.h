// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/board_description.h"
#include "support/boards/firmware.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

namespace usb_test {

/// What a board has for its host, cut into what one transfer can take: whole packets, the last one
/// of any length.
class Packets
{
public:
  explicit Packets(Transport transport);

  /// The line's bytes.
  void add(std::span<const std::uint8_t> bytes);
  /// A packet as it is.
  void add_packet(const Bytes &packet)
  {
    transfers_.push_back(packet);
  }
  /// Packets have at most so many bytes of the line's.
  void fill(std::size_t payload)
  {
    payload_ = payload;
  }

  bool empty() const
  {
    return transfers_.empty();
  }
  /// There must be one.
  Bytes take();
  void clear()
  {
    transfers_.clear();
  }

private:
  const std::size_t packet_;       ///< bytes, of the bulk endpoint
  const std::size_t status_bytes_; ///< that begin each
  std::size_t payload_;
  std::deque<Bytes> transfers_;
};

} // namespace usb_test
