// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_port.h"
#include "tactor/serial/system_roots.h"

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

namespace tactor {

/// How long is waited for what.
struct UsbPatience
{
  /// Until a request of the set-up is answered; there are at most 6.
  std::chrono::milliseconds request{ 1000 };
  /// Until a write has been taken. The longest one needs 89 ms on the line.
  std::chrono::milliseconds write{ 1000 };
  /// Between two looks at what is plugged in, while watched; where udevd runs, a change is seen at
  /// once.
  std::chrono::milliseconds look{ 1000 };
};

/// Boards on USB, over CDC-ACM, FTDI and CH340.
///
/// A port has a libusb context and an event thread of its own, which calls its events: a slow
/// receiver delays no other board. write() fills a transfer that was allocated at open and submits
/// it, which waits neither for the board nor for the event thread. A port must not be destroyed
/// from within one of its events.
///
/// Methods of one bus must not be called by two threads at once, watch() not from within `changed`;
/// ports are independent of the bus and may outlive it. `changed` is called on a thread of the bus.
class UsbSerialBus : public SerialBus
{
public:
  explicit UsbSerialBus(UsbPatience patience = {}, SystemRoots roots = {});
  ~UsbSerialBus() override;

  [[nodiscard]] tl::expected<std::vector<SerialDevice>, DriverError> list() override;
  [[nodiscard]] tl::expected<std::unique_ptr<SerialPort>, DriverError>
  open(const SerialDevice &device, SerialPort::Events events, std::stop_token stop = {}) override;
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
