// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/shaker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace synth {

namespace {

constexpr int kPoints = 33;
constexpr double kRisen = 0.9;

/// A fall cannot take no time.
constexpr Time kShortestFall = std::chrono::microseconds(100);

/// Share of the rise time from rest that a rise takes: from s to 0.9 t, along t − (t − s) e^(−x).
double
share_of_rise(double start, double target)
{
  if (start >= kRisen * target && target > 0)
    return 0;
  return target > 0 ? std::log10((target - start) / ((1 - kRisen) * target)) : 1;
}

} // namespace

tactor::MotorParameters
shaker(Time rise, double volts_max)
{
  tactor::RiseTimeTable table{
    .step_volts = volts_max / (kPoints - 1), .size = kPoints, .milliseconds = {}, .least_volts = 0
  };
  const double milliseconds = std::chrono::duration<double, std::milli>(rise).count();
  for (int start = 0; start < kPoints; start++)
    for (int target = 0; target < kPoints; target++)
      table.milliseconds.push_back(milliseconds * share_of_rise(start, target));
  return { .rise_time = tactor::RiseTime(std::move(table)),
           .start_volts = 0,
           .hold_volts = 0,
           .fall_time = std::max(rise, kShortestFall),
           .thresholds_measured = true };
}

} // namespace synth
