// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libusb.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace tactor {

/// Devices that a transport takes for boards. data/udev/70-visuotactile.rules has the same.
struct UsbId
{
  std::uint16_t vendor;
  std::uint16_t product; ///< 0: any
};

bool is_one_of(const libusb_device_descriptor &device, std::span<const UsbId> ids);

/// A request on the default control pipe (USB 2.0, 9.3).
struct ControlRequest
{
  std::uint8_t type;    ///< bmRequestType
  std::uint8_t request; ///< bRequest
  std::uint16_t value;  ///< wValue
  std::uint16_t index;  ///< wIndex
  /// Data stage: the bytes to send, or as many as to receive.
  std::vector<std::uint8_t> data{};
};

/// How to reach a board's serial line, as a transport derives it from the descriptors.
struct SerialLine
{
  std::string_view transport;         ///< "cdc-acm", "ftdi", "ch340"
  std::vector<int> interfaces;        ///< to claim in this order and release in reverse
  std::uint8_t in_endpoint = 0;       ///< bulk
  std::uint8_t out_endpoint = 0;      ///< bulk
  int in_packet = 0;                  ///< bytes, > status_bytes
  int status_bytes = 0;               ///< at the begin of each packet, not from the line
  std::vector<ControlRequest> set_up; ///< 57600 baud 8N1
  std::vector<ControlRequest> ready;  ///< DTR and RTS on, which resets many boards
  /// DTR and RTS off, on boards that are reset when DTR is on again; empty for others.
  std::vector<ControlRequest> hang_up;
};

/// A line over the first bulk endpoint in each direction of an interface. None if one is missing or
/// has an illegal packet size (USB 2.0, 5.8.3).
std::optional<SerialLine> bulk_line(const libusb_interface_descriptor &interface);

/// The first alternate setting of each interface, in the device's order.
std::vector<const libusb_interface_descriptor *>
first_settings(const libusb_config_descriptor &config);

/// The bulk_line() of the first interface, if the device is one of these.
std::optional<SerialLine> first_line(const libusb_device_descriptor &device,
                                     const libusb_config_descriptor &config,
                                     std::span<const UsbId> ids);

} // namespace tactor
