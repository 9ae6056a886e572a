// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_line.h"

#include <array>

namespace tactor {

/// Vendors of boards.
inline constexpr std::array kCdcAcmDevices{
  UsbId{ 0x2341, 0 }, // Arduino
  UsbId{ 0x2a03, 0 }, // Arduino (arduino.org)
  UsbId{ 0x16c0, 0 }, // Teensy
  UsbId{ 0x2e8a, 0 }, // Raspberry Pi
  UsbId{ 0x239a, 0 }, // Adafruit
  UsbId{ 0x1b4f, 0 }, // SparkFun
  UsbId{ 0x2886, 0 }, // Seeed
  UsbId{ 0x303a, 0 }, // Espressif
  UsbId{ 0x1209, 0 }, // pid.codes, open hardware
  UsbId{ 0x1a86, 0 }, // WCH, USB chips of many boards
};

/// Boards with an ATmega16U2 or 8U2 whose DTR resets the ATmega that drives the motors: Uno, Mega,
/// Mega ADK (boards.txt of Arduino's AVR core). And the USB chips of WCH, which boards wire alike.
inline constexpr std::array kDtrResets{
  UsbId{ 0x2341, 0x0001 }, UsbId{ 0x2341, 0x0010 }, UsbId{ 0x2341, 0x003f },
  UsbId{ 0x2341, 0x0042 }, UsbId{ 0x2341, 0x0043 }, UsbId{ 0x2341, 0x0044 },
  UsbId{ 0x2341, 0x0210 }, UsbId{ 0x2341, 0x0242 }, UsbId{ 0x2341, 0x0243 },
  UsbId{ 0x2a03, 0x0010 }, UsbId{ 0x2a03, 0x003f }, UsbId{ 0x2a03, 0x0042 },
  UsbId{ 0x2a03, 0x0043 }, UsbId{ 0x2a03, 0x0044 }, UsbId{ 0x1a86, 0 },
};

/// The serial line of the USB communications class (CDC 1.2, PSTN 1.2, abstract control model):
/// Uno, Mega, Leonardo, Teensy, RP2040. Only from vendors of boards: modems use it, too, and must
/// not get bytes of Firmata.
std::optional<SerialLine> cdc_acm_line(const libusb_device_descriptor &device,
                                       const libusb_config_descriptor &config);

} // namespace tactor
