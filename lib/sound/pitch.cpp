// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/pitch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sound {

namespace {

/// A hop's part of 40 ms: a period of 25 Hz.
constexpr double kSmooth = 0.12;
constexpr double kNothing = 1e-9;
/// A sound has a low pitch if that part of it is below kHighest.
constexpr double kLeastPart = 0.03;
constexpr double kLowest = 20;
constexpr double kHighest = 130;
/// 130 Hz to 8 kHz become 130 to 300 Hz.
constexpr double kMapped = 0.2;
/// Centers of the octaves are 2 to this above the first, 133 Hz.
constexpr double kFirstOctave = 133;

} // namespace

float
Pitch::add(const BandPowers &powers, const Powers &felt)
{
  low_ += kSmooth * (powers.sum[0] + powers.sum[1] + kNothing - low_);
  slope_ += kSmooth * (powers.low_slope + kNothing * kNothing - slope_);
  double total = 0;
  double octaves = 0;
  for (std::size_t band = 0; band < kBands; band++) {
    felt_[band] += kSmooth * (felt[band] + kNothing - felt_[band]);
    total += felt_[band];
    if (band >= kLowBands)
      octaves += felt_[band] * static_cast<double>(band - kLowBands);
  }
  double hz = 0;
  if (felt_[0] + felt_[1] > kLeastPart * total)
    hz = std::min(kHighest, kRate / std::numbers::pi
                                * std::asin(std::min(1.0, std::sqrt(slope_ / low_) / 2)));
  else
    hz = kHighest
         * std::pow(kFirstOctave / kHighest * std::exp2(octaves / (total - felt_[0] - felt_[1])),
                    kMapped);
  const double step = std::round(3 * std::log2(std::max(hz, kLowest) / kLowest));
  return static_cast<float>(std::round(kLowest * std::exp2(step / 3)));
}

} // namespace sound
