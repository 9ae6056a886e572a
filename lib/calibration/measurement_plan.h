// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tactor {

/// Steps to measure, and limits that protect the motors.
struct MeasurementSettings
{
  std::vector<int> tactors{ 0 };
  double volts_max = 3.0;
  double step_volts = 0.5; ///< grid of start and target voltages; 0.1 V in the paper
  int repetitions = 1;
  double max_duty = 0.35; ///< duty cycle of a tactor, below tactorsink's own limit of 0.4
};

/// One tactor at one voltage; all others are at zero.
struct MeasurementStretch
{
  Time begin{ 0 }; ///< since the start of the run
  Time duration{ 0 };
  int tactor = 0;
  double volts = 0;

  bool operator==(const MeasurementStretch &) const = default;
};

/// A part of a measurement that is played and recorded in one piece; it begins and ends at rest.
using MeasurementRun = std::vector<MeasurementStretch>;

/// Plans a measurement; all tactors take turns at each step. The steps are:
/// - from rest to 0.2…1.0 V (start voltage);
/// - from 1.5 V down to the same voltages (hold voltage);
/// - all steps of the grid that leave at least a tenth of the way to 90 %.
///
/// A run lasts about half a minute. No tactor is on for more than 1.5 s in a row. At most a million
/// steps. An error states what was expected and what was found.
tl::expected<std::vector<MeasurementRun>, std::string>
plan_measurement(const MeasurementSettings &settings);

/// Duration of a run.
Time length_of(const MeasurementRun &run);

} // namespace tactor
