// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/driver.h"
#include "tactor/serial_port.h"
#ifdef HAVE_USB
#include "tactor/usb/usb_serial_bus.h"
#endif

namespace tactor {

std::unique_ptr<SerialBus>
make_serial_bus()
{
#ifdef HAVE_USB
  return std::make_unique<UsbSerialBus>();
#else
  throw DriverError(DriverError::Kind::not_found, "this build has no USB");
#endif
}

} // namespace tactor
