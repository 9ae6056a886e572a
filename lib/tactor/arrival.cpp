// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/arrival.h"

#include <algorithm>
#include <cmath>

namespace tactor {

namespace {

/// Step and tolerance of the search for the arrival time.
constexpr Time kSearchStep = std::chrono::milliseconds(1);
constexpr Time kSearchGoal = std::chrono::microseconds(1);

/// A shorter pulse does not start a motor at rest.
constexpr Time kShortestKick = std::chrono::milliseconds(10);

/// Tolerance on a whole number of frames: durations are rounded to nanoseconds.
constexpr double kSameFrames = 1e-6;

/// Amplitudes closer than this are the same.
constexpr double kSameVolts = 1e-6;

/// A motor with less than this left of its vibration is at rest.
constexpr double kStillVolts = 0.1 * kStartVolts;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// The paper's data block: the rise time in whole frames, rounded up, but no more than fit into
/// max_lead.
Time
whole_frames(Time rise, Time frame, Time max_lead)
{
  const double whole = std::ceil(seconds(rise) / seconds(frame) - kSameFrames);
  return std::min(static_cast<Time::rep>(whole), max_lead / frame) * frame;
}

/// The latest time in [earliest, effect] from which the motor rises to 90 % of `volts` by `effect`;
/// `earliest` if there is none.
Time
exact_time(const MotorModel &motor, Time earliest, Time effect, double volts)
{
  const RiseTime &rise_time = motor.parameters().rise_time;
  const auto arrives = [&](Time time) {
    return time + rise_time(motor.amplitude(time), volts) <= effect;
  };
  const double now = motor.amplitude(earliest);
  if (std::abs(motor.amplitude(effect) - now) < kSameVolts)
    return std::max(effect - rise_time(now, volts), earliest);

  // The amplitude still changes, so the rise time depends on the arrival. It is not monotonic, as
  // Eq. 1 is not: search backward in steps, then bisect.
  if (arrives(effect))
    return effect;
  Time late = effect;
  Time early = effect;
  while (!arrives(early)) {
    if (early == earliest)
      return earliest;
    late = early;
    early = std::max(early - kSearchStep, earliest);
  }
  while (late - early > kSearchGoal) {
    const Time middle = early + (late - early) / 2;
    (arrives(middle) ? early : late) = middle;
  }
  return early;
}

} // namespace

Time
kick_time(const MotorModel &motor, const Change &change, const PlannerSettings &settings)
{
  if (!settings.kick_start)
    return Time(0);
  const Time kick = overdrive_time(motor.parameters().rise_time, settings.volts_max, change.volts);
  if (kick == Time(0))
    return kick;
  const Time time = std::max(kick, kShortestKick);
  return motor.amplitude(change.effect - time) < kStillVolts ? time : Time(0);
}

Time
arrival_time(const MotorModel &motor, const Change &change, Time previous, Time kick,
             const PlannerSettings &settings)
{
  const auto &[effect, frame, volts] = change;
  const Time earliest = std::min(std::max(previous, effect - settings.max_lead), effect);
  if (settings.compensation == Compensation::none)
    return effect;
  if (settings.compensation == Compensation::exact)
    return kick > Time(0) ? std::max(effect - kick, earliest)
                          : exact_time(motor, earliest, effect, volts);
  const Time rise
      = kick > Time(0) ? kick : motor.parameters().rise_time(motor.amplitude(earliest), volts);
  return std::max(effect - whole_frames(rise, frame, settings.max_lead), earliest);
}

} // namespace tactor
