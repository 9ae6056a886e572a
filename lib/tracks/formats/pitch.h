// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

#include <algorithm>
#include <cmath>

/// Pitch in formats of one actuator, .haptic's frequency and AHAP's sharpness: from 0, dull, to 1,
/// sharp. In Hz as MPEG's reference encoder takes it (AhapEncoder in
/// github.com/MPEGGroup/HapticReferenceSoftware).
namespace tactile {

inline constexpr double kDullest = 65;   ///< Hz
inline constexpr double kSharpest = 300; ///< Hz

inline double
frequency_of(double pitch)
{
  return kDullest + (kSharpest - kDullest) * std::clamp(pitch, 0.0, 1.0);
}

/// To four decimals, which give the frequency back in whole Hz.
inline float
pitch_of(float frequency)
{
  const double pitch = (static_cast<double>(frequency) - kDullest) / (kSharpest - kDullest);
  return static_cast<float>(std::round(std::clamp(pitch, 0.0, 1.0) * 1e4) / 1e4);
}

} // namespace tactile
