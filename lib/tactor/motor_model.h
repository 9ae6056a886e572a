// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/rise_time.h"

#include <optional>
#include <vector>

namespace tactor {

/// Until 10 % of a step down is left (paper, Section 4: within one frame, 33 ms).
inline constexpr Time kFallTime = std::chrono::milliseconds(30);

/// Properties of one motor; the defaults are the paper's. They hold for gamepads, suits and devices
/// of Intiface, too: no maker publishes rise times of those (docs/guide/calibration.md).
struct MotorParameters
{
  RiseTime rise_time{};
  double start_volts = kStartVolts; ///< least that starts it
  double hold_volts = kStartVolts;  ///< least that keeps it turning, ≤ start_volts
  Time fall_time = kFallTime;       ///< until 10 % of a step down is left
  /// From the driver's write() to the first motion. Unknown: Driver::transport_latency().
  std::optional<Time> latency{};
  /// Start and hold volts were measured, and hold instead of PlannerSettings::volts_min.
  bool thresholds_measured = false;
  /// Volts for the levels 0, 1/(n − 1), …, 1, linear in between; empty: level × full scale.
  std::vector<double> level_volts{};
};

/// Model of a vibration motor. Its state is the vibration amplitude, as the voltage that would
/// sustain it. After a step of the voltage the amplitude approaches the new steady state
/// exponentially. A rise reaches 90 % of the steady state after RiseTime's time; of a fall 10 % of
/// the step are left after fall_time (paper, Section 4: within one frame, 33 ms). A rise from 90 %
/// or more, which Eq. 1 does not cover, is as fast as a fall. A rise time of zero is a jump.
/// Voltages below start_volts, or hold_volts for a motor that turns, have a steady state of 0.
class MotorModel
{
public:
  /// A motor at rest.
  explicit MotorModel(MotorParameters parameters = {});
  explicit MotorModel(RiseTime rise_time);

  /// The voltage is `volts` from `time` on; a time before the last one is taken as the last one.
  void set(Time time, double volts);

  /// Amplitude in volts at `time`; for times before the last set() that at the last set().
  double amplitude(Time time) const;

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

/// How long `drive_volts` take to bring a motor at rest to 90 % of `volts`: the inverse of
/// MotorModel::amplitude(). With T the rise time to 90 % of drive, the amplitude is
/// drive · (1 − 10^(−t / T)), and the time T · lg(drive / (drive − 0.9 volts)). 0 unless drive >
/// volts > 0.
Time overdrive_time(const RiseTime &rise_time, double drive_volts, double volts);

} // namespace tactor
