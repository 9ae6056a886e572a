// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"
#include "tactor/serial/line_use.h"

#include <tl/expected.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace tactor {

/// An open serial line to a board, 57600 baud 8N1. The destructor cancels transfers, waits for
/// running events and until the line has carried what was written, and releases the board. Not
/// thread-safe, and not to be destroyed within an event.
class SerialPort
{
public:
  /// Most bytes in one write.
  static constexpr std::size_t kMaxWrite = 512;
  /// Time of a byte on the line: ten bits of 35 · 8 cycles, an Arduino's 57600 baud at 16 MHz.
  static constexpr std::chrono::nanoseconds kByteTime = std::chrono::microseconds(175);

  /// Called on the port's thread, one at a time, never within a call to the port.
  struct Events
  {
    std::function<void(std::span<const std::uint8_t>)> received; ///< in order, in any pieces
    /// The last write() is complete; the next one may be made.
    std::function<void()> written;
    /// The board is gone or takes no bytes, with the reason in one line. The last event.
    std::function<void(const std::string &)> lost;
    bool realtime = false; ///< request real-time scheduling of the port's thread
    /// Raise DTR and RTS. That resets many boards and 3D printers; others are silent until then.
    bool raises_dtr = true;
  };

  virtual ~SerialPort() = default;

  /// Begins to send 1…kMaxWrite bytes and returns at once. False, and nothing is sent, while an
  /// earlier write is pending, and after `lost`.
  virtual bool write(std::span<const std::uint8_t> bytes) = 0;
};

/// A serial line that can be opened.
struct SerialDevice
{
  std::string serial;   ///< serial number; may be empty, and clones may share one
  std::string bus_path; ///< bus and ports, "1-2.3": constant while it is plugged in
  std::string name;     ///< for messages: manufacturer and product, or else its USB ids
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string transport; ///< "cdc-acm", "ftdi", "ch340"

  bool operator==(const SerialDevice &) const = default;
};

/// A bus with serial lines. Not thread-safe.
class SerialBus
{
public:
  virtual ~SerialBus() = default;

  /// The devices that are plugged in now, in a stable order. The error is `failed`: the bus cannot
  /// be used.
  [[nodiscard]] virtual tl::expected<std::vector<SerialDevice>, DriverError> list() = 0;

  /// Opens a line. Errors: not_found, busy, permission (the text names the udev rule and the
  /// command that installs it), failed. A board that does not answer may take seconds; a request to
  /// `stop` on any thread makes it fail at once.
  [[nodiscard]] virtual tl::expected<std::unique_ptr<SerialPort>, DriverError>
  open(const SerialDevice &device, SerialPort::Events events, std::stop_token stop = {}) = 0;

  /// Resets a board that speaks no more, by DTR. Errors: as open(), and `failed` if the device is
  /// not known to be reset by that.
  [[nodiscard]] virtual tl::expected<void, DriverError> reset(const SerialDevice & /*device*/)
  {
    return tl::unexpected(DriverError{ DriverError::Kind::failed, "it has no line for a reset" });
  }

  /// Whether a program has the operating system's line to the device open, from which open() would
  /// take it. Opens nothing.
  virtual LineUse use(const SerialDevice & /*device*/)
  {
    return {};
  }

  /// Whether the operating system has no line to it, as after its last user was killed.
  virtual bool is_left(const SerialDevice & /*device*/)
  {
    return false;
  }

  /// From now on calls `changed` on any thread after something was plugged in or out, also where no
  /// udevd runs. With nullptr no call is made or running after this returns, and it cannot fail.
  /// The error is `failed`: the bus cannot be used.
  virtual tl::expected<void, DriverError> watch(std::function<void()> changed) = 0;
};

/// The bus of this build; the error is not_found if it has none.
[[nodiscard]] tl::expected<std::unique_ptr<SerialBus>, DriverError> make_serial_bus();

/// make_serial_bus(), or that of a test.
using MakeSerialBus = std::function<tl::expected<std::unique_ptr<SerialBus>, DriverError>()>;

} // namespace tactor
