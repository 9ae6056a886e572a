// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/driver_error.h"
#include "tactor/layout.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactor {

/// The motors that a server drives for this program.
struct ServedDevice
{
  std::string name;   ///< for messages
  std::string server; ///< its name and version
  int tactors = 0;
  std::vector<std::string> motors{}; ///< name of each tactor
  Layout layout{};
  double step = 0;           ///< the smallest one of a level
  Time longest_latency{ 0 }; ///< of Conversation::latency()
  bool has_watchdog = false;
};

/// State machine for a conversation with a server that drives devices. The owner sends what next()
/// returns, and reports connections, messages and the time. It never waits, reads no clock and is
/// not thread-safe.
class Conversation
{
public:
  enum class State
  {
    asking,  ///< for the devices
    playing, ///< from here on device() is known
    closing,
    closed, ///< all that stops the motors was sent
    failed, ///< see failure()
  };

  /// Messages that may be sent once for each reason.
  static constexpr std::size_t kMostWarnings = 8;

  virtual ~Conversation() = default;

  /// The parts of the server that it drives, as the user named them. Known before the connection.
  virtual std::vector<std::string> parts() const = 0;

  /// A connection is open. All begins anew.
  virtual void begin(Time now) = 0;
  /// A message of the server, of any content.
  virtual void received(std::string_view text, Time now) = 0;
  /// The server closed the connection; `why` names it.
  virtual void hung_up(const std::string &why)
  {
    fail({ DriverError::Kind::lost, why });
  }
  /// The level of each tactor, 0…1 (others are clamped, NaN is 0); further tactors are at zero.
  virtual void set_levels(std::span<const double> levels) = 0;
  /// A message to send now. To be called until there is none.
  virtual std::optional<std::string> next(Time now) = 0;
  /// When to call next() if nothing else happens.
  virtual std::optional<Time> deadline() const = 0;
  /// Motors to zero. Also after a failure.
  virtual void close(Time now) = 0;
  virtual ServedDevice device() const = 0;
  /// The time from levels to the device, as measured last.
  virtual Time latency() const = 0;

  State state() const
  {
    return state_;
  }
  const DriverError &failure() const
  {
    return failure_;
  }
  /// Whether another connection at once, not later, helps against the failure.
  bool tries_again() const
  {
    return tries_again_;
  }
  /// Problems that the user should know of, each once.
  std::vector<std::string> take_warnings()
  {
    return std::exchange(warnings_, {});
  }

protected:
  void enter(State state)
  {
    state_ = state;
    tries_again_ = false;
  }
  void fail(DriverError why, bool tries_again = false)
  {
    state_ = State::failed;
    failure_ = std::move(why);
    tries_again_ = tries_again;
  }
  void warn(const std::string &text)
  {
    if (warned_.size() >= kMostWarnings || std::ranges::find(warned_, text) != warned_.end())
      return;
    warned_.push_back(text);
    warnings_.push_back(text);
  }

private:
  State state_ = State::closed;
  DriverError failure_;
  bool tries_again_ = false;
  std::vector<std::string> warnings_;
  std::vector<std::string> warned_;
};

} // namespace tactor
