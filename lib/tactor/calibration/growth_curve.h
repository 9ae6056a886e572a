// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

namespace tactor {

/// steady − (steady − before) exp(−((t − onset) / tau)^roundness) from the onset on, `before` up to it.
struct GrowthCurve
{
  double before = 0;
  double steady = 0;
  double onset_s = 0;
  double tau_s = 0;
  double roundness = 1;
  double rms = 0; ///< of what the fit leaves

  double operator()(double time_s) const;
  /// When it gets to `amplitude`, between before and steady.
  double time_of(double amplitude) const;
};

/// What is known of a motor's rises before one is looked at: means and standard deviations.
struct GrowthPrior
{
  double onset_s = 0;
  double onset_deviation_s = 1;         ///< next to nothing is known of the onset
  double log_roundness = 0;             ///< an exponential…
  double log_roundness_deviation = 0.3; ///< …more or less
};

/// Fits a curve to an envelope sampled from `first_s` on, of which the level before is known, the steady one nearly; `noise` is the mean
/// square of the envelope at rest, and `independence` how many of its samples per sample are independent.
GrowthCurve fit_growth(std::span<const double> envelope, double rate, double first_s, double before,
                       double steady, double noise, double independence,
                       const GrowthPrior &prior = {});

} // namespace tactor
