// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"
#include "tactor/serial/serial_line.h"
#include "tactor/serial/serial_port.h"

#include <libusb.h>
#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace tactor {

/// A libusb context. It knows the devices that were there when it was made, and later ones only
/// where udevd tells: whoever wants to know what is plugged in now makes a new one.
class UsbContext
{
public:
  /// DriverError (failed) if USB cannot be used.
  [[nodiscard]] static tl::expected<UsbContext, DriverError> create();

  libusb_context *get() const
  {
    return context_.get();
  }

private:
  struct Exit
  {
    void operator()(libusb_context *context) const
    {
      libusb_exit(context);
    }
  };

  explicit UsbContext(libusb_context *context) : context_(context)
  {
  }

  std::unique_ptr<libusb_context, Exit> context_;
};

struct DeviceUnref
{
  void operator()(libusb_device *device) const
  {
    libusb_unref_device(device);
  }
};

/// A device that a transport knows how to talk to.
struct UsbSerialDevice
{
  std::unique_ptr<libusb_device, DeviceUnref> handle;
  SerialDevice device;
  SerialLine line;
  std::uint8_t address = 0; ///< on its bus; another one each time it is plugged in
};

/// Every serial line that is plugged in, by bus and ports. Nothing is opened and no board is
/// disturbed: descriptors and strings are those that the kernel has read (/sys/bus/usb/devices);
/// where there is no sysfs, serial number and name are left empty. DriverError (failed) if they
/// cannot be listed. The result must not outlive the context.
[[nodiscard]] tl::expected<std::vector<UsbSerialDevice>, DriverError>
find_serial_devices(const UsbContext &context);

} // namespace tactor
