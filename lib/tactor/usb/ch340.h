// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/usb/serial_line.h"

namespace tactor {

/// WCH's USB serial chips CH340 and CH341: most clones of Uno, Mega and Nano.
std::optional<SerialLine> ch340_line(const libusb_device_descriptor &device,
                                     const libusb_config_descriptor &config);

} // namespace tactor
