// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/rumble_features.h"

#include "sound/level.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace sound {

namespace {

/// A hop's part of 0.1 and of 2 s.
constexpr double kSmooth = 0.05;
constexpr double kSeconds = 0.0025;
constexpr double kSilenceDb = -70;
/// Added to powers, so that silence is nothing and numbers too small for the format, which are
/// slow, do not come.
constexpr double kNothing = 1e-9;

} // namespace

void
RumbleFeatures::follow_parts(const BandPowers &powers)
{
  part_.deep += powers.sum[0] / kPart;
  part_.low += (powers.sum[0] + powers.sum[1]) / kPart;
  part_.peak = std::max(part_.peak, powers.low_peak);
  if (++hops_ % kPart != 0)
    return;
  parts_[hops_ / kPart % kParts] = std::exchange(part_, {});
  double low = kNothing;
  double peak = kNothing;
  double mean = 0;
  double square = kNothing;
  for (const Part &part : parts_) {
    low += part.low / kParts;
    peak = std::max(peak, part.peak);
    mean += std::sqrt(part.deep) / kParts;
    square += part.deep / kParts;
  }
  crest_ = decibels(peak / low);
  varying_ = 10 * std::sqrt(std::max(0.0, square - mean * mean)) / (mean + std::sqrt(kNothing));
}

std::span<const float, RumbleFeatures::count>
RumbleFeatures::add(const BandPowers &powers)
{
  for (std::size_t band = 0; band < kBands; band++)
    smooth_[band] += kSmooth * (powers.sum[band] + kNothing - smooth_[band]);
  voicing_ += kSmooth * (powers.voicing + kNothing - voicing_);
  uneven_ += kSmooth
             * (std::accumulate(powers.uneven.begin() + kLowBands, powers.uneven.end(), kNothing)
                    / (kBands - kLowBands)
                - uneven_);
  follow_parts(powers);
  const double db = decibels(smooth_[0]);
  const auto over = [&](double power) {
    return static_cast<float>(std::clamp(db - decibels(power), -30.0, 30.0));
  };
  features_[deep] = static_cast<float>(db);
  features_[over_middle] = over(smooth_[1] + smooth_[2] + smooth_[3] + smooth_[4]);
  features_[over_high] = over(smooth_[5] + smooth_[6] + smooth_[7]);
  features_[over_bass] = over(smooth_[1]);
  features_[crest] = static_cast<float>(crest_);
  features_[voicing] = static_cast<float>(10 * voicing_);
  features_[uneven] = static_cast<float>(uneven_);
  features_[varying] = static_cast<float>(varying_);
  features_[over_seconds] = static_cast<float>(std::clamp(db - seconds_, -30.0, 30.0));
  seconds_ += kSeconds * (std::max(db, kSilenceDb) - seconds_);
  return features_;
}

} // namespace sound
