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

/// A serial line to a board, 57600 baud 8N1, whatever carries it. Open for as long as it exists:
/// the destructor cancels what is on the way, waits until no event is being called any more and the
/// line has carried what was taken, and releases the board. Not thread-safe: one thread at a time,
/// and none destroys it from within an event.
class SerialPort
{
public:
  /// Most bytes in one write.
  static constexpr std::size_t kMaxWrite = 512;
  /// What a byte takes on the line: ten bits, as an Arduino of 16 MHz makes 57600 baud, 35 · 8
  /// cycles each.
  static constexpr std::chrono::nanoseconds kByteTime = std::chrono::microseconds(175);

  /// What comes from the line. Called on the port's own thread, one at a time, never from within a
  /// call to the port.
  struct Events
  {
    std::function<void(std::span<const std::uint8_t>)> received; ///< in order, any cuts
    /// All bytes of the last write() have been handed to the board: the next one may come.
    std::function<void()> written;
    /// The board is gone, or does not take what it is sent; nothing follows. Why, in one line.
    std::function<void(const std::string &)> lost;
    bool realtime = false; ///< the port's thread asks to be real-time
  };

  virtual ~SerialPort() = default;

  /// Begins to send 1…kMaxWrite bytes and returns at once. False, and nothing is sent, as long as
  /// an earlier write is on the way, and after `lost`.
  virtual bool write(std::span<const std::uint8_t> bytes) = 0;
};

/// A serial line that could be opened.
struct SerialDevice
{
  std::string serial;   ///< number, may be empty or shared by cheap clones
  std::string bus_path; ///< "1-2.3": bus and ports, the same as long as it stays plugged in there
  std::string name;     ///< to be read by people: manufacturer and product
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string transport;   ///< "cdc-acm", "ftdi", "ch340"
  bool is_adapter = false; ///< a bare USB serial chip, behind which may be anything

  bool operator==(const SerialDevice &) const = default;
};

/// Where serial lines are found. Not thread-safe: one thread at a time.
class SerialBus
{
public:
  virtual ~SerialBus() = default;

  /// What is plugged in now, in a stable order. DriverError (failed) if the bus itself cannot be
  /// used.
  [[nodiscard]] virtual tl::expected<std::vector<SerialDevice>, DriverError> list() = 0;

  /// Opens one. DriverError: not_found, busy, permission (the text names the udev rule and the
  /// command that installs it), failed. A board that does not answer may need seconds; `stop`,
  /// requested by any thread, ends that at once with an error (failed).
  [[nodiscard]] virtual tl::expected<std::unique_ptr<SerialPort>, DriverError>
  open(const SerialDevice &device, SerialPort::Events events, std::stop_token stop = {}) = 0;

  /// Whether a program has the operating system's own line to the device open, which open() would
  /// take away from it. Nothing is opened for that.
  virtual LineUse use(const SerialDevice & /*device*/)
  {
    return {};
  }

  /// Whether whoever had it open last was killed: the operating system has no line to it.
  virtual bool is_left(const SerialDevice & /*device*/)
  {
    return false;
  }

  /// From now on `changed` is called after something was plugged in or out, from any thread;
  /// nullptr: no more, and none is being called after this returns. Works also where no udevd runs.
  /// DriverError (failed) if the bus itself cannot be used; never of nullptr.
  virtual tl::expected<void, DriverError> watch(std::function<void()> changed) = 0;
};

/// The bus that this build has; DriverError (not_found) if it has none.
[[nodiscard]] tl::expected<std::unique_ptr<SerialBus>, DriverError> make_serial_bus();

/// Where a bus comes from: make_serial_bus(), or a test.
using MakeSerialBus = std::function<tl::expected<std::unique_ptr<SerialBus>, DriverError>()>;

} // namespace tactor
