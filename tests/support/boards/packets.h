// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/board_description.h"
#include "support/boards/firmware.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

namespace usb_test {

/// Data from a board to its host, in transfers of whole packets. The last packet may be short.
class Packets
{
public:
  explicit Packets(Transport transport);

  /// Adds payload bytes.
  void add(std::span<const std::uint8_t> bytes);
  /// Adds a raw packet.
  void add_packet(const Bytes &packet)
  {
    transfers_.push_back(packet);
  }
  /// Limits the payload of a packet, in bytes.
  void fill(std::size_t payload)
  {
    payload_ = payload;
  }

  bool empty() const
  {
    return transfers_.empty();
  }
  /// Must not be empty.
  Bytes take();
  void clear()
  {
    transfers_.clear();
  }

private:
  const std::size_t packet_;       ///< size of the bulk endpoint's packets
  const std::size_t status_bytes_; ///< at the start of each packet
  std::size_t payload_;
  std::deque<Bytes> transfers_;
};

} // namespace usb_test
