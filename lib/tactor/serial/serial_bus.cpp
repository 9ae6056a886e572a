// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/serial_port.h"

#ifdef HAVE_LIBUSB
#include "tactor/serial/usb_serial_bus.h"
#endif

namespace tactor {

tl::expected<std::unique_ptr<SerialBus>, DriverError>
make_serial_bus()
{
#ifdef HAVE_LIBUSB
  return std::make_unique<UsbSerialBus>();
#else
  return tl::unexpected(DriverError{
      DriverError::Kind::not_found,
      "no tactor board can be used: this was built without USB (meson option usb, libusb-1.0)" });
#endif
}

} // namespace tactor
