// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/motor_limits.h"
#include "tactor/priority_mutex.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactor {

/// Records when the motors of a device were on, for as long as this process runs, by a monotonic
/// clock.
///
/// CommandPlanner keeps MotorLimits by running time and the times at which commands are due. This
/// class keeps them by the time at which levels leave for the device, so that they hold if the
/// pipeline's clock jumps, if a thread gets no CPU time, and in the next pipeline. A level that
/// exceeds a limit by kGrace is cut; it stays at zero until the film has released it or
/// kLongestRest is over.
///
/// All times are of one monotonic clock. Any thread.
class DeviceAccount
{
public:
  /// Commands that end a cue in time are not overtaken.
  static constexpr Time kGrace = std::chrono::milliseconds(10);
  /// Shorter breaks do not end a cue. Half of the planner's: a command may be late.
  static constexpr Time kShortestRest = MotorUse::kShortestRest / 2;
  /// As CommandPlanner's.
  static constexpr Time kLongestRest = std::chrono::seconds(3);

  /// The account of a device, by a name that does not change.
  static std::shared_ptr<DeviceAccount> of(const std::string &device);

  /// Initially there are none.
  void set_limits(const MotorLimits &limits);

  /// Admits levels, 0 or more, that leave for the device: zeroes those whose time is over, and
  /// records the others. Motors beyond them are at zero.
  void admit(std::span<double> levels, Time now);
  /// When a level of the last admit() is over, or may begin.
  std::optional<Time> deadline() const;

  /// The motors' on-times until now.
  std::vector<MotorUse> uses(Time now) const;
  /// Levels that were cut.
  std::uint64_t cuts() const;

private:
  struct Motor
  {
    MotorUse use = MotorUse(kShortestRest);
    Time next = Time::max(); ///< when another level may be admitted
    std::optional<Time> cut_at{};
  };

  double admit(Motor &motor, double level, Time now);

  mutable PriorityMutex mutex_; ///< guards all below
  MotorLimits limits_ = MotorLimits::none();
  std::vector<Motor> motors_;
  std::uint64_t cuts_ = 0;
};

} // namespace tactor
