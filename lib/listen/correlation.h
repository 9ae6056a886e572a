// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/onsets.h"

#include <cstdint>
#include <span>

namespace listen {

/// The place in a film's reference that fits onsets best.
struct Fit
{
  double step = 0;  ///< of the reference, at the first onset
  double score = 0; ///< in standard deviations of chance
};

/// Places more than so many steps from the best one fit by chance: 32 ms.
inline constexpr int kPeakWidth = 8;

/// Correlates changes of onsets, weighted(), with a reference, the signs() of a film's onsets.
/// `rate`: steps of the reference for one of the onsets. The reference has
/// reference_steps(onsets.size(), rate, reach) steps. Those at most `near` from `reach` are places,
/// the others show chance.
Fit fit(std::span<const Bands> onsets, std::span<const std::uint8_t> reference, double rate,
        int reach, int near);

/// Steps of the reference for places from 0 to 2 · `reach`.
std::size_t reference_steps(std::size_t onsets, double rate, int reach);

} // namespace listen
