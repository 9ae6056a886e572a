// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/time.h"

#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tactor {

/// What is measured, and how gently.
struct MeasurementSettings
{
  std::vector<int> tactors{ 0 };
  double volts_max = 3.0;
  double step_volts = 0.5; ///< grid of start and target voltages; the paper's was 0.1 V
  int repetitions = 1;
  double max_duty = 0.35; ///< share of time for which a tactor is on, under tactorsink's own 0.4
};

/// One tactor at one voltage; all others at zero.
struct MeasurementStretch
{
  Time begin{ 0 }; ///< in its run
  Time duration{ 0 };
  int tactor = 0;
  double volts = 0;

  bool operator==(const MeasurementStretch &) const = default;
};

/// A part of a measurement that is played, recorded and kept in one piece; it begins and ends at
/// rest.
using MeasurementRun = std::vector<MeasurementStretch>;

/// A measurement in a known order: for each tactor in turn a step from rest to 0.2…1.0 V (start
/// voltage), from 1.5 V down to as much (hold voltage), then all steps of the grid of which a tenth
/// of the way and more is left to 90 %. Runs last about half a minute. No tactor is on for more
/// than 1.5 s in a row. At most a million steps. An error says what was expected and what came.
tl::expected<std::vector<MeasurementRun>, std::string>
plan_measurement(const MeasurementSettings &settings);

/// How long a run is.
Time length_of(const MeasurementRun &run);

} // namespace tactor
