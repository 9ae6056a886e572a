// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace sound {

inline double
decibels(double power)
{
  return 10 * std::log10(power + 1e-12);
}

/// The felt level of a power: 0 for −50 dB of full scale, 1 for −10 dB.
inline double
level_of(double power, double gain_db)
{
  constexpr double kFaintestDb = -50;
  constexpr double kStrongestDb = -10;
  return std::clamp((decibels(power) + gain_db - kFaintestDb) / (kStrongestDb - kFaintestDb), 0.0,
                    1.0);
}

} // namespace sound
