// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace tactor {

/// The vibration of an eccentric mass: its speed approaches a steady value exponentially, and the
/// amplitude is a power of the speed. From the onset on it is (s − (s − b) exp(−(t − onset) /
/// tau))^exponent, where s and b are the exponent-th roots of `steady` and `before`. With
/// exponent 1 the amplitude itself is exponential (MotorModel). With 2 it is an acceleration,
/// which is proportional to the square of the speed. The curve may rise or fall.
struct GrowthCurve
{
  double before = 0;
  double steady = 0;
  double onset_s = 0;
  double tau_s = 0;
  double exponent = 1;
  double rms = 0; ///< of the residuals

  /// Amplitudes at `first_s`, `first_s` + 1 / `rate`, …; seconds and samples per second.
  std::vector<double> sample(double first_s, double rate, std::size_t count) const;
  /// Time in seconds at which the curve reaches `amplitude`, between before and steady.
  double time_of(double amplitude) const;
};

/// Gaussian prior of a motor's rises: means and standard deviations.
struct GrowthPrior
{
  double onset_s = 0;
  double onset_deviation_s = 1;        ///< nearly uninformative
  double log_exponent = 0.35;          ///< about exponential…
  double log_exponent_deviation = 0.5; ///< …but uncertain
};

/// Applies the measurement chain to amplitudes: what the envelope of such a vibration looks like.
using GrowthLens = std::function<void(std::vector<double> &)>;

/// Fits a curve to an envelope sampled from `first_s` on. `before` is known, `steady` is a first
/// guess. `noise`: mean square of the envelope at rest. `independence`: the share of samples that
/// are statistically independent. `lens`, if any, is applied to the curve before comparison.
GrowthCurve fit_growth(std::span<const double> envelope, double rate, double first_s, double before,
                       double steady, double noise, double independence,
                       const GrowthPrior &prior = {}, const GrowthLens &lens = {});

} // namespace tactor
