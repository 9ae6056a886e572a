// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "tactor/rise_time.h"

#include <optional>
#include <span>
#include <vector>

namespace tactor {

/// A rise time that was measured.
struct RiseTimeSample
{
  double start_volts = 0;
  double target_volts = 0;
  double milliseconds = 0;
};

/// Least squares to the paper's quadratic form, with R² and 95 % intervals (Student's t). None if
/// the samples do not determine it: fewer than seven, or too few different voltages.
std::optional<QuadraticRiseTime> fit_quadratic(std::span<const RiseTimeSample> samples);

/// A table for use on 0…volts_max: where it was measured the median of the measurements, elsewhere
/// the quadratic, shifted by what it leaves nearby; no stronger target is slower from the same
/// start (pool adjacent violators). None without samples.
std::optional<RiseTimeTable> monotone_table(std::span<const RiseTimeSample> samples,
                                            double volts_max);

/// The rising sequence nearest to the values in the sense of least squares, weighted if there are
/// as many weights (pool adjacent violators).
std::vector<double> isotonic(std::span<const double> values, std::span<const double> weights = {});

} // namespace tactor
