// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/usb/serial_line.h"

namespace tactor {

/// The USB communications class' serial line (CDC 1.2, PSTN 1.2, abstract control model): Uno, Mega, Leonardo, Teensy, RP2040. Only from
/// vendors of boards: modems speak it too, and must not be asked for their capabilities.
std::optional<SerialLine> cdc_acm_line(const libusb_device_descriptor &device,
                                       const libusb_config_descriptor &config);

} // namespace tactor
