// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/ch340.h"

namespace tactor {

namespace {

constexpr std::uint8_t kToDevice = 0x40;   // host to device, vendor, device
constexpr std::uint8_t kFromDevice = 0xc0; // device to host, vendor, device
constexpr std::uint8_t kReadVersion = 0x5f;
constexpr std::uint8_t kSerialInit = 0xa1;
constexpr std::uint8_t kWriteRegisters = 0x9a;
constexpr std::uint8_t kModemControl = 0xa4;

} // namespace

std::optional<SerialLine>
ch340_line(const libusb_device_descriptor &device, const libusb_config_descriptor &config)
{
  std::optional<SerialLine> line = first_line(device, config, kCh340Devices);
  if (!line)
    return std::nullopt;
  line->transport = "ch340";
  line->set_up = {
    { kFromDevice, kReadVersion, 0, 0, { 0, 0 } },
    { kToDevice, kSerialInit, 0, 0 },
    { kToDevice, kWriteRegisters, 0x1312, 0x9883 }, // prescaler and divisor of 57600 baud
    { kToDevice, kWriteRegisters, 0x0f2c, 0x0010 },
    { kToDevice, kWriteRegisters, 0x2518, 0x00c3 }, // line control: receive, send, 8 bits
  };
  line->ready = { { kToDevice, kModemControl, 0xff9f, 0 } }; // inverted
  line->hang_up = { { kToDevice, kModemControl, 0xffff, 0 } };
  return line;
}

} // namespace tactor
