// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace tactor {

/// What an eccentric mass does: its speed approaches a steady one exponentially, and the amplitude
/// is a power of the speed: (s − (s − b) exp(−(t − onset) / tau))^roundness from the onset on, s
/// and b being the roundness-th roots of `steady` and `before`. 1: the amplitude itself is
/// exponential (MotorModel); 2: acceleration, which grows with the square of the speed. It rises,
/// or falls.
struct GrowthCurve
{
  double before = 0;
  double steady = 0;
  double onset_s = 0;
  double tau_s = 0;
  double roundness = 1;
  double rms = 0; ///< of what the fit leaves

  /// Amplitudes at `first_s`, `first_s` + 1 / `rate`, …
  std::vector<double> sample(double first_s, double rate, std::size_t count) const;
  /// When it gets to `amplitude`, between before and steady.
  double time_of(double amplitude) const;
};

/// What is known of a motor's rises before one is looked at: means and standard deviations.
struct GrowthPrior
{
  double onset_s = 0;
  double onset_deviation_s = 1;         ///< next to nothing is known of the onset
  double log_roundness = 0.35;          ///< an exponential…
  double log_roundness_deviation = 0.5; ///< …more or less
};

/// Turns amplitudes into what the way to the envelope makes of them.
using GrowthLens = std::function<void(std::vector<double> &)>;

/// Fits a curve to an envelope sampled from `first_s` on, of which the level before is known, the
/// steady one nearly; `noise` is the mean square of the envelope at rest, and `independence` how
/// many of its samples per sample are independent. The curve is compared as `lens`, if any, shows
/// it.
GrowthCurve fit_growth(std::span<const double> envelope, double rate, double first_s, double before,
                       double steady, double noise, double independence,
                       const GrowthPrior &prior = {}, const GrowthLens &lens = {});

} // namespace tactor
