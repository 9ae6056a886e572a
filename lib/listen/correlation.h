// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/onsets.h"

#include <cstdint>
#include <span>

namespace listen {

/// Where in a film's reference onsets fit best.
struct Fit
{
  double step = 0;  ///< of the reference, at the first onset
  double score = 0; ///< of chance's standard deviations
};

/// Onsets that fit elsewhere by chance are at least so many steps away: 32 ms.
inline constexpr int kPeakWidth = 8;

/// Moves the onsets over the reference, signs() of its steps. `rate`: steps of the reference to one
/// of the onsets. The reference holds reference_steps(onsets.size(), rate, reach).
Fit fit(std::span<const Onset> onsets, std::span<const std::uint8_t> reference, double rate,
        int reach);

/// Steps that are needed for places from 0 to 2 · `reach`.
std::size_t reference_steps(std::size_t onsets, double rate, int reach);

} // namespace listen
