// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/rumble_features.h"

#include "sound/level.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace sound {

namespace {

/// A hop's part of 0.1, 1 and 2 s.
constexpr double kSmooth = 0.05;
constexpr double kSecond = 0.005;
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
  const double uneven_now
      = std::accumulate(powers.uneven.begin() + kLowBands, powers.uneven.end(), kNothing)
        / (kBands - kLowBands);
  voicing_ += kSmooth * (powers.voicing + kNothing - voicing_);
  long_voicing_ += kSecond * (powers.voicing + kNothing - long_voicing_);
  uneven_ += kSmooth * (uneven_now - uneven_);
  long_uneven_ += kSecond * (uneven_now - long_uneven_);
  std::array<float, kBands> &levels = levels_[hops_ % levels_.size()];
  double change = kNothing;
  for (std::size_t band = kLowBands; band < kBands; band++) {
    const float level = std::max(static_cast<float>(decibels(powers.sum[band])), -70.0F);
    change += std::abs(level - levels[band]) / (kBands - kLowBands);
    levels[band] = level;
  }
  busy_ += kSeconds * (change - busy_);
  follow_parts(powers);
  const double db = decibels(smooth_[0]);
  const auto over_band = [&](double power) {
    return static_cast<float>(std::clamp(db - decibels(power), -30.0, 30.0));
  };
  features_[deep] = static_cast<float>(db);
  for (std::size_t band = 1; band < kBands; band++)
    features_[over + band - 1] = over_band(smooth_[band]);
  features_[crest] = static_cast<float>(crest_);
  features_[voicing] = static_cast<float>(10 * voicing_);
  features_[uneven] = static_cast<float>(uneven_);
  features_[long_voicing] = static_cast<float>(10 * long_voicing_);
  features_[long_uneven] = static_cast<float>(long_uneven_);
  features_[busy] = static_cast<float>(busy_);
  features_[varying] = static_cast<float>(varying_);
  features_[over_seconds] = static_cast<float>(std::clamp(db - seconds_, -30.0, 30.0));
  seconds_ += kSeconds * (std::max(db, kSilenceDb) - seconds_);
  return features_;
}

} // namespace sound
