// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A measurement of simulated motors: planned, played without a clock, heard by a simulated sensor, analysed.
#pragma once

#include "tactor/calibration/measurement_plan.h"
#include "tactor/calibration/simulated_sensor.h"
#include "tactor/calibration/step.h"
#include "tactor/calibration/step_response.h"
#include "tactor/calibration/tactor_calibration.h"

#include <vector>

/// What tactorsink's trace would hold of a run, each command issued on time.
inline std::vector<tactor::IssuedCommand>
trace_of(const tactor::MeasurementRun &run)
{
  std::vector<tactor::IssuedCommand> trace;
  for (const tactor::MeasurementStretch &stretch : run)
    trace.push_back({ .command = { .effect = stretch.begin,
                                   .tactor = stretch.tactor,
                                   .volts = stretch.volts },
                      .issued = stretch.begin });
  return trace;
}

/// The responses to all steps of a plan.
inline std::vector<tactor::StepResponse>
measure(const tactor::MeasurementSettings &settings, const std::vector<tactor::MotorParameters> &motors,
        tactor::SimulatedSensor sensor)
{
  std::vector<tactor::StepResponse> responses;
  for (const tactor::MeasurementRun &run : plan_measurement(settings)) {
    const std::vector<tactor::IssuedCommand> trace = trace_of(run);
    const tactor::Time end = length_of(run);
    const tactor::Recording recording = hear(trace, motors, sensor, end);
    sensor.seed++;
    const std::vector<tactor::Step> steps = steps_of(trace, end);
    for (const tactor::Step &step : steps) {
      const int channel = sensor.separate ? step.tactor : 0;
      responses.push_back(measure_step(recording, channel, step, { 15, 160 }));
    }
  }
  return responses;
}
