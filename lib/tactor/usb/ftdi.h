// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/usb/serial_line.h"

namespace tactor {

/// FTDI's USB serial chips (FT232R, FT2232, FT4232, FT232H, FT-X; the first line of those with several): Arduino Nano and Duemilanove,
/// serial cables.
std::optional<SerialLine> ftdi_line(const libusb_device_descriptor &device,
                                    const libusb_config_descriptor &config);

} // namespace tactor
