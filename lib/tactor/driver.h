// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/driver_error.h"
#include "tactor/line_time.h"

#include <tl/expected.hpp>

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace tactor {

/// What a driver tells by itself.
struct DriverEvent
{
  enum class Kind
  {
    opened,   ///< which board it is, and how to choose another
    warning,  ///< what the user should know of it
    lost,     ///< it went away; the driver looks for it by itself
    refused,  ///< it is back, but cannot be used; told once for each reason
    returned, ///< it is back, and does what was written last
  };

  Kind kind;
  std::string text; ///< one line
};

/// What a driver is opened with.
struct DriverConfig
{
  /// Which board: serial number or bus path; the simulator takes a file name (see there).
  std::string device;
  int max_tactors = 4096; ///< at most this many are wanted, 1…4096
  int min_tactors = 1;    ///< a board with fewer is refused
  /// Where no device is named: adapters behind which no board has answered yet are asked, too. They
  /// may be 3D printers, which a question may reset.
  bool asks_strangers = true;
  double full_scale_volts = 3.0; ///< volts at the motor when a board's output is fully on
  bool realtime = false;         ///< threads that carry levels to the board ask to be real-time
  std::stop_token stop{};        ///< any thread ends an open() that waits; it fails then
  /// Called from any thread, one call at a time, between the beginning of open() and the end of
  /// close(), and also from within these. It may call status(), nothing else.
  std::function<void(const DriverEvent &)> notify{};
};

/// What is known of a board now.
struct DriverStatus
{
  std::string board;            ///< to be read by people: name, serial number, bus path
  std::string firmware;         ///< name and version
  bool is_there = false;        ///< false while it is lost
  bool has_watchdog = false;    ///< its motors stop by themselves when the host falls silent
  std::vector<int> pins;        ///< of each tactor
  std::uint64_t bytes = 0;      ///< sent since open()
  std::uint64_t reconnects = 0; ///< times it came back since open()
};

/// A board that drives tactors. Not thread-safe: one thread at a time (the scheduler's, once it
/// runs), but for status(). close() and the destructor leave every motor at zero. A board that goes
/// away and may come back is not an error of write(), but an event.
class Driver
{
public:
  virtual ~Driver() = default;

  /// Opens the board; every motor is at zero afterwards.
  [[nodiscard]] virtual tl::expected<void, DriverError> open(const DriverConfig &config) = 0;

  /// How many tactors the open board can drive, at most `config.max_tactors`; 0 when not open.
  virtual int tactors() const = 0;

  /// Smallest difference in volts that the board can make; 0 if it is continuous.
  virtual double resolution() const = 0;

  /// Time from write() to the motor's terminals when all tactors change; part of every command's
  /// lead.
  virtual Time transport_latency() const = 0;

  /// What there is of transport_latency() for tactors that change, one after the other, and what a
  /// chair may be too large for.
  virtual LineTime line() const
  {
    return {};
  }

  /// While a motor is on, write() is to be called at least this often even if nothing changes: a
  /// board may silence motors whose host hangs. 0: never.
  virtual Time refresh_interval() const
  {
    return Time(0);
  }

  /// Sets all tactors at once: `volts` has 1…tactors() values of 0…full_scale_volts; tactors beyond
  /// volts.size() are at zero. `now` is the running time.
  [[nodiscard]] virtual tl::expected<void, DriverError> write(std::span<const double> volts,
                                                              Time now)
      = 0;

  /// Motors to zero, board released. Never fails; harmless when not open.
  virtual void close() noexcept = 0;

  /// From any thread. After close() that of the last board.
  virtual DriverStatus status() const = 0;
};

} // namespace tactor
