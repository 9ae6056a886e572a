// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/rise_time.h"

#include <optional>
#include <vector>

namespace tactor {

/// How long until 10 % of a step down is left (paper, Section 4: within one frame, 33 ms).
inline constexpr Time kFallTime = std::chrono::milliseconds(30);

/// What is known of one motor; the defaults are the paper's.
struct MotorParameters
{
  RiseTime rise_time{};
  double start_volts = kStartVolts; ///< less does not get it off its rest
  double hold_volts = kStartVolts;  ///< once it turns it goes on down to this, at most start_volts
  Time fall_time = kFallTime;       ///< until 10 % of a step down is left
  /// From the driver's being told to the first motion; unknown: what the driver says of itself.
  std::optional<Time> latency{};
  /// Start and hold volts were measured: they count, whatever PlannerSettings::volts_min is.
  bool thresholds_measured = false;
  /// Volts for the levels 0, 1/(n − 1), …, 1, linear in between; empty: level × full scale.
  std::vector<double> level_volts{};
};

/// A vibration motor as the simulator and the planner see it. Its state is its vibration amplitude,
/// expressed as the voltage that would sustain it. After a step of the voltage the amplitude
/// approaches the new steady state exponentially: rising so that 90 % of the steady state is
/// reached after RiseTime's time, falling so that 10 % of the step is left after fall_time (paper,
/// Section 4: falling was within one frame, 33 ms). A rise that starts at 90 % or more is as fast
/// as a fall: Eq. 1 says nothing of it. A rise time of zero is a jump. Voltages below
/// start_volts, or hold_volts for a motor that turns, have a steady state of 0.
class MotorModel
{
public:
  /// A motor at rest.
  explicit MotorModel(MotorParameters parameters = {});
  explicit MotorModel(RiseTime rise_time);

  /// The voltage becomes `volts` at `time`; times do not go back (an earlier time is taken as the
  /// last one). The same voltage again changes nothing.
  void set(Time time, double volts);

  /// Amplitude in volts at `time`; before the last set() it is that of the last set().
  double amplitude(Time time) const;

  /// The voltage set last.
  double volts() const;

  const MotorParameters &parameters() const;

private:
  MotorParameters parameters_;
  Time since_ = Time::min();
  double volts_ = 0;  ///< as set
  double steady_ = 0; ///< amplitude that volts_ sustains
  double from_ = 0;   ///< amplitude at since_
  double rate_ = 0;   ///< 1/s of the exponential since then; 0: the amplitude stays at from_
};

/// How long `drive_volts` need to bring a motor at rest to 90 % of `volts`: MotorModel::amplitude()
/// the other way about. As the amplitude is drive · (1 − 10^(−t / T)), T being the rise time to 90
/// % of drive, it is T · lg(drive / (drive − 0.9 volts)). 0 if the drive is not stronger than what
/// it leads to, or drives nothing.
Time overdrive_time(const RiseTime &rise_time, double drive_volts, double volts);

} // namespace tactor
