// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/packets.h"

#include <algorithm>
#include <array>
#include <utility>

namespace usb_test {

namespace {

constexpr std::array<std::uint8_t, 2> kStatus{ 0x01,
                                               0x60 }; // FT232R: no modem status, transmitter empty
constexpr std::size_t kLongestRead = 512;              // longest transfer of the host

} // namespace

Packets::Packets(Transport transport)
    : packet_(transport == Transport::ch340 ? 32 : 64),
      status_bytes_(transport == Transport::ftdi ? 2 : 0), payload_(packet_ - status_bytes_)
{
}

void
Packets::add(std::span<const std::uint8_t> bytes)
{
  do {
    Bytes transfer;
    for (bool full = true; full && transfer.size() + packet_ <= kLongestRead;) {
      const std::size_t payload = std::min(bytes.size(), payload_);
      if (payload == 0 && !transfer.empty())
        break;
      if (status_bytes_ > 0)
        transfer.insert(transfer.end(), kStatus.begin(), kStatus.end());
      transfer.insert(transfer.end(), bytes.begin(), bytes.begin() + payload);
      bytes = bytes.subspan(payload);
      full = payload == packet_ - status_bytes_;
    }
    transfers_.push_back(std::move(transfer));
  } while (!bytes.empty());
}

Bytes
Packets::take()
{
  Bytes first = std::move(transfers_.front());
  transfers_.pop_front();
  return first;
}

} // namespace usb_test
