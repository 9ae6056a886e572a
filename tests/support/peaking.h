// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <complex>

/// What a peaking filter makes of a sine of `at` Hz: the analog prototype of R. Bristow-Johnson's
/// cookbook, H(s) = (s² + s A/Q + 1) / (s² + s/(A Q) + 1).
inline double
peaking(double frequency, double gain_db, double q, double at)
{
  const double a = std::pow(10, gain_db / 40);
  const std::complex<double> s(0, at / frequency);
  return std::abs((s * s + s * a / q + 1.0) / (s * s + s / (a * q) + 1.0));
}
