// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "tactor/rise_time.h"

#include <optional>
#include <span>
#include <vector>

namespace tactor {

/// A measured rise time.
struct RiseTimeSample
{
  double start_volts = 0;
  double target_volts = 0;
  double milliseconds = 0;
};

/// Least-squares fit of the paper's quadratic form (Eq. 1), with R² and 95 % confidence intervals
/// (Student's t). None if the samples do not determine it: fewer than seven, or too few different
/// voltages.
std::optional<QuadraticRiseTime> fit_quadratic(std::span<const RiseTimeSample> samples);

/// A rise-time table for 0…volts_max: the median of the measurements where there are any, elsewhere
/// the quadratic form corrected by nearby residuals. Where the samples do not determine that, as
/// those from rest alone, it is a parabola over the offset, else a constant. From the same start
/// voltage, a higher target is never slower (pool adjacent violators). None without samples.
std::optional<RiseTimeTable> monotone_table(std::span<const RiseTimeSample> samples,
                                            double volts_max);

/// Isotonic regression: the non-decreasing sequence nearest to the values by least squares (pool
/// adjacent violators). Weighted if there are as many weights as values.
std::vector<double> isotonic(std::span<const double> values, std::span<const double> weights = {});

} // namespace tactor
