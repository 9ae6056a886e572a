// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/firmware.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace usb_test {

enum class Transport
{
  cdc_acm,
  ftdi,
  ch340,
};

constexpr Transport kTransports[] = { Transport::cdc_acm, Transport::ftdi, Transport::ch340 };

struct BoardDescription
{
  Transport transport = Transport::cdc_acm;
  std::string port = "1-1"; ///< where it is plugged in
  std::string serial = "75833353035351F0C0A1";
  std::string manufacturer = "Arduino (www.arduino.cc)";
  std::string product = "Mega 2560";
  std::optional<std::uint16_t> vendor{};
  Bytes descriptors{}; ///< instead of the transport's
  double baud = 0;     ///< of the emulated wire from host to board; 0: no time passes on it
  /// Bytes that the USB chip takes at once and lets out as the wire goes (an ATmega16U2 as on a
  /// Mega: 128); 0: a transfer is done when its last byte has left. What a chip still holds when
  /// the kernel's driver has set its baud rate is lost.
  std::size_t chip = 0;
  std::chrono::microseconds chip_time{ 0 }; ///< that it needs to begin with one
  /// From when the kernel's driver has the board back to when it sets its baud rate; none: as
  /// measured of the transport's driver.
  std::optional<std::chrono::microseconds> kernel_opens{};
};

Bytes usb_descriptors(Transport transport, std::optional<std::uint16_t> vendor = {});

/// As umockdev_testbed_add_from_string() has it: a device of its own below `syspath`, with the node
/// `/dev/bus/usb/BUS/ADDRESS`.
std::string umockdev_entry(const BoardDescription &description, const std::string &syspath, int bus,
                           int address);
std::string usb_node(int bus, int address);

std::chrono::microseconds kernel_opens(const BoardDescription &description);

} // namespace usb_test
