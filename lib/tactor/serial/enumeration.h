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

/// A libusb context. It sees devices that are plugged in later only where udevd runs, so that a
/// complete list needs a new context.
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

/// A device that a transport supports.
struct UsbSerialDevice
{
  std::unique_ptr<libusb_device, DeviceUnref> handle;
  SerialDevice device;
  SerialLine line;
  std::uint8_t address = 0; ///< on its bus; changes each time it is plugged in
};

/// All serial lines that are plugged in, sorted by bus and ports. No device is opened: descriptors
/// and strings are those of the kernel (/sys/bus/usb/devices). Without sysfs there are no serial
/// numbers, and names are USB ids. The error (failed) says why they cannot be listed. The result
/// must not outlive the context.
[[nodiscard]] tl::expected<std::vector<UsbSerialDevice>, DriverError>
find_serial_devices(const UsbContext &context);

} // namespace tactor
