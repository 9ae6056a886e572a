// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/motor_model.h"

#include <cmath>
#include <limits>
#include <random>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr Time kForever = 1000s; ///< long enough for any motor to settle

RiseTime
constant(double milliseconds)
{
  return RiseTime(RiseTimeTable{ .step_volts = 1, .size = 1, .milliseconds = { milliseconds } });
}

/// A motor that has settled at `volts` by time 0.
MotorModel
settled(double volts, const RiseTime &rise_time = {})
{
  MotorModel motor(rise_time);
  motor.set(-kForever, volts);
  return motor;
}

/// The first time in [begin, end] at which the amplitude is at least `volts`, if it rises
/// throughout.
Time
reaches(const MotorModel &motor, double volts, Time begin, Time end)
{
  fail_unless(motor.amplitude(end) >= volts);
  if (motor.amplitude(begin) >= volts)
    return begin;
  while (end - begin > 1ns) {
    const Time middle = begin + (end - begin) / 2;
    (motor.amplitude(middle) >= volts ? end : begin) = middle;
  }
  return end;
}

} // namespace

CHECK_TEST(test_at_rest)
{
  MotorModel motor;
  fail_unless(motor.volts() == 0);
  for (const Time time : { Time::min(), Time(0), Time(1h), Time::max() })
    fail_unless(motor.amplitude(time) == 0);
  motor.set(1s, 0);
  fail_unless(motor.amplitude(2s) == 0);
}

CHECK_TEST(test_rises_within_rise_time)
{
  const RiseTime quadratic;
  for (double start = 0; start < 3.0; start += start == 0 ? 0.5 : 0.1)
    for (double target = 0.5; target <= 3.0; target += 0.1) {
      if (start >= 0.9 * target)
        continue;
      MotorModel motor = settled(start);
      motor.set(5s, target);
      fail_unless(motor.volts() == target);
      const Time took = reaches(motor, 0.9 * target, 5s, 6s) - 5s;
      fail_unless(std::abs((took - quadratic(start, target)).count()) <= 2,
                  "from %g to %g V in %g ms instead of %g", start, target, took.count() / 1e6,
                  quadratic(start, target).count() / 1e6);
      fail_unless_near(motor.amplitude(5s + kForever), target, 1e-9);
    }
}

CHECK_TEST(test_rises_exponentially)
{
  // From rest 10 % of the step remain after one rise time, 1 % after two, 0.1 % after three.
  MotorModel motor(constant(60));
  motor.set(1s, 2.0);
  fail_unless(motor.amplitude(1s) == 0);
  fail_unless_near(motor.amplitude(1s + 30ms), 2.0 * (1 - std::sqrt(0.1)), 1e-12);
  fail_unless_near(motor.amplitude(1s + 60ms), 1.8, 1e-12);
  fail_unless_near(motor.amplitude(1s + 120ms), 1.98, 1e-12);
  fail_unless_near(motor.amplitude(1s + 180ms), 1.998, 1e-12);
}

CHECK_TEST(test_rise_times_from_a_table)
{
  for (const double ms : { 0.001, 1.0, 60.0, 5000.0 }) {
    MotorModel motor = settled(1.0, constant(ms));
    motor.set(0s, 2.5);
    fail_unless_near(reaches(motor, 2.25, 0s, kForever).count(), ms * 1e6, 2);
  }
  MotorModel jumps = settled(1.0, constant(0));
  jumps.set(1s, 2.5);
  fail_unless(jumps.amplitude(1s) == 2.5);
  fail_unless(jumps.amplitude(2s) == 2.5);
}

CHECK_TEST(test_falls_within_a_frame)
{
  fail_unless(kFallTime == 30ms);
  for (double start = 0.6; start <= 3.0; start += 0.1)
    for (double target = 0.5; target < start; target += 0.1) {
      MotorModel motor = settled(start);
      const double from = motor.amplitude(0s);
      motor.set(0s, target);
      fail_unless_near(motor.amplitude(30ms), target + 0.1 * (from - target), 1e-9);
      fail_unless_near(motor.amplitude(60ms), target + 0.01 * (from - target), 1e-9);
    }
  // Below 0.5 V it stops.
  for (const double target : { 0.0, 0.3, 0.4999, -1.0, std::numeric_limits<double>::quiet_NaN() }) {
    MotorModel motor = settled(2.0);
    motor.set(0s, target);
    fail_unless_near(motor.amplitude(30ms), 0.2, 1e-9);
    fail_unless_near(motor.amplitude(kForever), 0, 1e-9);
  }
}

CHECK_TEST(test_rise_that_is_nearly_done)
{
  // After a step from 90 % or more, 10 % of it remain after 30 ms, too.
  for (const double start : { 1.81, 1.9, 1.99 }) {
    MotorModel motor = settled(start);
    motor.set(0s, 2.0);
    fail_unless_near(motor.amplitude(30ms), 2.0 - 0.1 * (2.0 - start), 1e-9);
  }
}

CHECK_TEST(test_no_start_below_half_a_volt)
{
  MotorModel motor;
  motor.set(0s, 0.4999);
  fail_unless(motor.volts() == 0.4999);
  fail_unless(motor.amplitude(1s) == 0);
  motor.set(1s, 0.5);
  fail_unless(motor.amplitude(1s + kForever) > 0.49);
}

CHECK_TEST(test_retarget_is_continuous)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> volts(0.0, 3.0);
  std::uniform_int_distribution<Time::rep> pause(0, Time(120ms).count());
  MotorModel motor;
  Time time = 0s;
  for (int i = 0; i < 5000; i++) {
    time += Time(pause(random));
    const double before = motor.amplitude(time);
    motor.set(time, volts(random));
    fail_unless(motor.amplitude(time) == before);
    // The steepest course is a fall of 3 V in 30 ms or the fastest rise. In this range Eq. 1 gives
    // at least 30 ms, except close to 90 %.
    fail_unless_near(motor.amplitude(time + 1us), before, 1e-3);
    fail_unless(before >= 0 && before <= 3.0);
  }
}

CHECK_TEST(test_retarget_during_a_rise)
{
  // From rest to 2 V in 60 ms. At 1 V the target becomes 3 V, again in 60 ms: 3 − 2 · (0.3 / 2)^(t
  // / 60 ms).
  MotorModel motor(constant(60));
  motor.set(0s, 2.0);
  const Time half(std::llround(60e6 * std::log10(2.0)));
  fail_unless_near(motor.amplitude(half), 1.0, 1e-6);
  motor.set(half, 3.0);
  for (const double share : { 0.0, 0.25, 0.5, 1.0, 2.0 })
    fail_unless_near(motor.amplitude(half + Time(std::llround(share * 60e6))),
                     3.0 - 2.0 * std::pow(0.15, share), 1e-6);
}

CHECK_TEST(test_times_that_go_back)
{
  // A time before the last command counts as that command's time.
  MotorModel back;
  back.set(100ms, 3.0);
  back.set(200ms, 1.0);
  back.set(50ms, 2.5);
  MotorModel same;
  same.set(100ms, 3.0);
  same.set(200ms, 1.0);
  same.set(200ms, 2.5);
  for (Time time = 0s; time < 1s; time += 7ms)
    fail_unless(back.amplitude(time) == same.amplitude(time));
  fail_unless(back.volts() == 2.5);
  // Before the last command's time the amplitude is the one at that time.
  fail_unless(back.amplitude(Time::min()) == back.amplitude(200ms));
  fail_unless(back.amplitude(0s) == back.amplitude(200ms));
}

CHECK_TEST(test_same_voltage_again)
{
  MotorModel twice;
  MotorModel once;
  once.set(0s, 2.0);
  for (const Time time : { 0ms, 10ms, 20ms, 90ms })
    twice.set(time, 2.0);
  for (Time time = 0s; time < 500ms; time += 3ms)
    fail_unless(twice.amplitude(time) == once.amplitude(time));
}

// Stiction: a motor at rest needs its start voltage, a turning one goes on down to its hold
// voltage.
CHECK_TEST(start_and_hold_volts_are_each_motors_own)
{
  const RiseTimeTable table{
    .step_volts = 3, .size = 2, .milliseconds = { 60, 60, 60, 60 }, .least_volts = 0.3
  };
  MotorModel motor(MotorParameters{
      .rise_time = RiseTime(table), .start_volts = 0.9, .hold_volts = 0.3, .fall_time = 50ms });
  motor.set(0s, 0.8);
  fail_unless(motor.amplitude(1s) == 0);
  motor.set(1s, 1);
  fail_unless_near(motor.amplitude(1060ms), 0.9, 1e-6);
  motor.set(2s, 0.4);
  fail_unless_near(motor.amplitude(2050ms), 0.4 + 0.1 * 0.6, 1e-3);
  fail_unless_near(motor.amplitude(4s), 0.4, 1e-6);
  motor.set(4s, 0.2);
  fail_unless_near(motor.amplitude(4050ms), 0.04, 1e-3);
  motor.set(6s, 0.4); // at rest, and below the start voltage
  fail_unless(motor.amplitude(8s) < 1e-6);
}

CHECK_MAIN(motor_model)
