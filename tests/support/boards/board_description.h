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
  std::string port = "1-1"; ///< USB port
  std::string serial = "75833353035351F0C0A1";
  std::string manufacturer = "Arduino (www.arduino.cc)";
  std::string product = "Mega 2560";
  std::optional<std::uint16_t> vendor{};
  bool is_known = true; ///< it has been a tactor board before
  Bytes descriptors{};  ///< instead of the transport's
  double baud = 0;      ///< of the emulated wire from host to board; with 0 it takes no time
  /// Size of the USB chip's transmit buffer in bytes (128 in the ATmega16U2 of a Mega). With 0, a
  /// transfer completes when its last byte has left. When the kernel's driver sets the baud rate,
  /// the buffer is lost.
  std::size_t chip = 0;
  std::chrono::microseconds chip_time{ 0 }; ///< from a byte's arrival to its start on the wire
  /// From when the kernel's driver gets the board back until it sets the baud rate. By default as
  /// measured for the transport's driver.
  std::optional<std::chrono::microseconds> kernel_opens{};
};

Bytes usb_descriptors(Transport transport, std::optional<std::uint16_t> vendor = {});
Bytes usb_descriptors(const BoardDescription &description);

/// A device below `syspath` with the node `/dev/bus/usb/BUS/ADDRESS`, in the format of
/// umockdev_testbed_add_from_string().
std::string umockdev_entry(const BoardDescription &description, const std::string &syspath, int bus,
                           int address);
std::string usb_node(int bus, int address);

std::chrono::microseconds kernel_opens(const BoardDescription &description);

} // namespace usb_test
