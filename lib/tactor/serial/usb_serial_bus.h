// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_port.h"
#include "tactor/serial/system_roots.h"
#include "tactor/serial/usb_patience.h"

#include <functional>
#include <memory>
#include <vector>

namespace tactor {

/// Boards on USB, over CDC-ACM, FTDI and CH340.
///
/// Each port has its own libusb context and its own thread for events, so that a slow receiver
/// delays no other board. write() submits a transfer that was allocated at open and never blocks.
///
/// `changed` of watch() is called on a thread of the bus and must not call watch(). Ports may
/// outlive the bus.
class UsbSerialBus : public SerialBus
{
public:
  explicit UsbSerialBus(UsbPatience patience = {}, SystemRoots roots = {});
  ~UsbSerialBus() override;

  [[nodiscard]] tl::expected<std::vector<SerialDevice>, DriverError> list() override;
  [[nodiscard]] tl::expected<std::unique_ptr<SerialPort>, DriverError>
  open(const SerialDevice &device, SerialPort::Events events, std::stop_token stop = {}) override;
  [[nodiscard]] tl::expected<void, DriverError> reset(const SerialDevice &device) override;
  tl::expected<void, DriverError> watch(std::function<void()> changed) override;
  LineUse use(const SerialDevice &device) override;
  bool is_left(const SerialDevice &device) override;

private:
  class Watch;

  UsbPatience patience_;
  SystemRoots roots_;
  std::unique_ptr<Watch> watch_;
};

} // namespace tactor
