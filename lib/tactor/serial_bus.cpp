// SPDX-License-Identifier: LGPL-2.1-or-later
//
// MERGE: a bus on which nothing is ever plugged in. This file goes when the USB bus defines make_serial_bus().
#include "tactor/driver.h"
#include "tactor/serial_port.h"

namespace tactor {

namespace {

class EmptyBus final : public SerialBus
{
public:
  std::vector<SerialDevice> list() override
  {
    return {};
  }
  std::unique_ptr<SerialPort> open(const SerialDevice &device, SerialPort::Events) override
  {
    throw DriverError(DriverError::Kind::not_found, "there is no " + device.name);
  }
  void watch(std::function<void()>) override
  {
  }
};

} // namespace

std::unique_ptr<SerialBus>
make_serial_bus()
{
  return std::make_unique<EmptyBus>();
}

} // namespace tactor
