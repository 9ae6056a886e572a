// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_line.h"

#include <array>

namespace tactor {

inline constexpr std::array kFtdiDevices{
  UsbId{ 0x0403, 0x6001 }, // FT232R
  UsbId{ 0x0403, 0x6010 }, // FT2232
  UsbId{ 0x0403, 0x6011 }, // FT4232
  UsbId{ 0x0403, 0x6014 }, // FT232H
  UsbId{ 0x0403, 0x6015 }, // FT-X
};

/// FTDI's USB serial chips (FT232R, FT2232, FT4232, FT232H, FT-X; the first line of those with
/// several): Arduino Nano and Duemilanove, serial cables.
std::optional<SerialLine> ftdi_line(const libusb_device_descriptor &device,
                                    const libusb_config_descriptor &config);

} // namespace tactor
