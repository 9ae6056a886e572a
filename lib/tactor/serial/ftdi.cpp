// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/ftdi.h"

namespace tactor {

namespace {

constexpr std::uint8_t kToDevice = 0x40; // host to device, vendor, device
constexpr std::uint8_t kReset = 0x00;
constexpr std::uint8_t kModemControl = 0x01;
constexpr std::uint8_t kBaudRate = 0x03;
constexpr std::uint8_t kData = 0x04;
constexpr std::uint8_t kLatencyTimer = 0x09;

} // namespace

std::optional<SerialLine>
ftdi_line(const libusb_device_descriptor &device, const libusb_config_descriptor &config)
{
  std::optional<SerialLine> line = first_line(device, config, kFtdiDevices);
  if (!line)
    return std::nullopt;
  // Chips with several lines count them from 1; with one, it is 0.
  const std::uint16_t index = first_settings(config).size() > 1 ? 1 : 0;
  line->transport = "ftdi";
  line->status_bytes = 2; // modem and line status
  line->set_up = {
    { kToDevice, kReset, 0, index },
    { kToDevice, kBaudRate, 0xc034, index },     // 3 MHz / (52 + 1/8): 57554 baud
    { kToDevice, kData, 0x0008, index },         // 8 bits, no parity, 1 stop bit
    { kToDevice, kLatencyTimer, 0x0001, index }, // short packets wait 1 ms, not 16
  };
  line->ready = {
    { kToDevice, kModemControl, 0x0101, index }, // DTR
    { kToDevice, kModemControl, 0x0202, index }, // RTS
  };
  line->hang_up = {
    { kToDevice, kModemControl, 0x0100, index }, // DTR
    { kToDevice, kModemControl, 0x0200, index }, // RTS
  };
  return line;
}

} // namespace tactor
