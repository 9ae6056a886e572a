// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/enumeration.h"
#include "tactor/serial/serial_line.h"

#include <libusb.h>

#include <chrono>
#include <stop_token>

namespace tactor {

/// Makes a request and waits for its answer for `patience`, or until any thread requests `stop`.
/// LIBUSB_SUCCESS or a libusb_error: TIMEOUT, INTERRUPTED after a stop, PIPE if the device refuses,
/// NO_DEVICE, IO, NO_MEM. The answer's data is dropped. No other thread may handle the context's
/// events meanwhile.
int control_transfer(const UsbContext &context, libusb_device_handle *handle,
                     const ControlRequest &request, std::chrono::milliseconds patience,
                     const std::stop_token &stop);

} // namespace tactor
