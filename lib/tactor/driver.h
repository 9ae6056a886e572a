// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/device_account.h"
#include "tactor/driver_error.h"
#include "tactor/layout.h"
#include "tactor/line_time.h"

#include <tl/expected.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace tactor {

/// A change that a driver reports.
struct DriverEvent
{
  enum class Kind
  {
    opened,      ///< which board, and how to choose another
    warning,     ///< a problem that the user should know of
    not_stopped, ///< motors may still be on after the end; the process may be about to end
    lost,        ///< the board went away; the driver looks for it
    refused,     ///< it is back, but cannot be used; once for each reason
    returned,    ///< it is back and has the levels written last
  };

  Kind kind;
  std::string text; ///< one line
};

struct DriverConfig
{
  /// Serial number or bus path of the board. For the simulator a file name, see Simulator.
  std::string device;
  int max_tactors = 4096; ///< tactors to use at most, 1…4096
  int min_tactors = 1;    ///< a board with fewer is refused
  /// Without `device`, and without a known board: probe the device that is there, if it is the only
  /// one and has not failed a probe. It may be anything.
  bool asks_a_stranger = true;
  double full_scale_volts = 3.0; ///< volts at the motor when a board's output is fully on
  bool realtime = false;         ///< request real-time scheduling for threads that carry levels
  bool guardian = false;         ///< run a Guardian where the board has no watchdog
  MotorLimits limits = MotorLimits::none(); ///< of account(), where there is one
  std::stop_token stop{};                   ///< cancels an open() that waits; it fails then
  /// Called on any thread, one call at a time, from the beginning of open() to the end of close(),
  /// also from within these. May call only status().
  std::function<void(const DriverEvent &)> notify{};
};

struct DriverStatus
{
  std::string board;         ///< for messages: name, serial number, bus path
  std::string firmware;      ///< name and version
  bool is_there = false;     ///< false while it is lost
  bool has_watchdog = false; ///< motors stop when the host falls silent
  /// "running", or why there is no Guardian; empty for boards that need none.
  std::string guardian;
  bool may_run = false;  ///< closed, but motors may still be on
  std::vector<int> pins; ///< of each tactor
  /// The name of each tactor, for drivers with DriverInfo::names_motors.
  std::vector<std::string> motors;
  std::uint64_t bytes = 0;      ///< sent since open()
  std::uint64_t reconnects = 0; ///< times it came back since open()
  std::uint64_t cuts = 0;       ///< levels that account() cut since open()
  std::uint64_t overtaken = 0;  ///< levels that newer ones replaced before they left, since open()
};

/// A board that drives tactors. One thread at a time, but for what any may call. close() and the
/// destructor leave all motors at zero. A board that goes away and may come back is an event, not
/// an error of write().
class Driver
{
public:
  virtual ~Driver() = default;

  /// Opens the board; all motors are at zero afterwards.
  [[nodiscard]] virtual tl::expected<void, DriverError> open(const DriverConfig &config) = 0;

  /// Tactors of the open board, at most `config.max_tactors`; 0 when not open.
  virtual int tactors() const = 0;

  /// How tactors of the open board stand, at most tactors(). By default a map of any grid is pooled
  /// to it; without places cell i has tactor i.
  virtual Layout layout() const
  {
    return {};
  }

  /// Smallest step of the board's output in volts; 0 if it is continuous.
  virtual double resolution() const = 0;

  /// Time from write() to the motor's terminals when all tactors change. Any thread: a server may
  /// become slower.
  virtual Time transport_latency() const = 0;

  /// The upper limit of transport_latency() while it is open.
  virtual Time longest_latency() const
  {
    return transport_latency();
  }

  /// The part of transport_latency() that depends on which tactors change.
  virtual LineTime line() const
  {
    return {};
  }

  /// While a motor is on, write() has to be called at least this often even if nothing changes, for
  /// the board's watchdog. 0: never.
  virtual Time refresh_interval() const
  {
    return Time(0);
  }

  /// Sets all tactors at once: `volts` has 1…tactors() values of 0…full_scale_volts; tactors beyond
  /// volts.size() are at zero. `now` is the running time.
  [[nodiscard]] virtual tl::expected<void, DriverError> write(std::span<const double> volts,
                                                              Time now)
      = 0;

  /// On-times of the open device's motors in this process, and the limits that write() keeps. Null
  /// where motors need none. Any thread.
  virtual std::shared_ptr<DeviceAccount> account() const
  {
    return nullptr;
  }

  /// Motors to zero, board released. Harmless when not open.
  virtual void close() noexcept = 0;

  /// Any thread. After close() that of the last board.
  virtual DriverStatus status() const = 0;
};

} // namespace tactor
