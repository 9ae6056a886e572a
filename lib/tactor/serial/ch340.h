// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_line.h"

#include <array>

namespace tactor {

inline constexpr std::array kCh340Devices{
  UsbId{ 0x1a86, 0x7523 }, // CH340
  UsbId{ 0x1a86, 0x7522 }, // CH340K
  UsbId{ 0x1a86, 0x5523 }, // CH341
  UsbId{ 0x4348, 0x5523 }, // CH341, older
};

/// WCH's USB serial chips CH340 and CH341: most clones of Uno, Mega and Nano.
std::optional<SerialLine> ch340_line(const libusb_device_descriptor &device,
                                     const libusb_config_descriptor &config);

} // namespace tactor
