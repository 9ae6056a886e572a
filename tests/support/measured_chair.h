// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A measurement of simulated motors: planned, played without a clock, recorded by a simulated
// sensor, analyzed.
#pragma once

#include "calibration/measurement_plan.h"
#include "calibration/simulated_sensor.h"
#include "calibration/step.h"
#include "calibration/step_response.h"
#include "calibration/tactor_calibration.h"

#include <cmath>
#include <vector>

/// The trace that tactorsink would write of a run if it issued each command on time.
inline std::vector<tactor::IssuedCommand>
trace_of(const tactor::MeasurementRun &run)
{
  std::vector<tactor::IssuedCommand> trace;
  for (const tactor::MeasurementStretch &stretch : run)
    trace.push_back(
        { .command = { .effect = stretch.begin, .tactor = stretch.tactor, .volts = stretch.volts },
          .issued = stretch.begin });
  return trace;
}

/// How vibrations rise. Exponential is MotorModel's. Squared is the acceleration of an eccentric
/// mass whose speed rises exponentially. Second order has two equal time constants in series, which
/// gives an S shape.
struct Growth
{
  const char *name;
  double (*share)(double);
};
inline constexpr Growth kGrowths[] = {
  { "exponential", nullptr },
  { "squared",
    [](double t) {
      return std::pow(1 - std::exp(-t), 2);
    } },
  { "second order",
    [](double t) {
      return 1 - (1 + t) * std::exp(-t);
    } },
};

/// The responses to all steps of a plan.
inline std::vector<tactor::StepResponse>
measure(const tactor::MeasurementSettings &settings,
        const std::vector<tactor::MotorParameters> &motors, tactor::SimulatedSensor sensor)
{
  std::vector<tactor::RecordedRun> runs;
  const auto plan = plan_measurement(settings);
  for (const tactor::MeasurementRun &run : *plan) {
    const std::vector<tactor::IssuedCommand> trace = trace_of(run);
    const tactor::Time end = length_of(run);
    runs.push_back({ hear(trace, motors, sensor, end), steps_of(trace, end) });
    sensor.seed++;
  }
  return measure_steps(runs, static_cast<int>(motors.size()), { 15, 160 });
}
