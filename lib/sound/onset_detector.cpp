// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/onset_detector.h"

#include "sound/level.h"
#include "sound/onset_weights.h"

#include <algorithm>
#include <numeric>

namespace sound {

namespace {

constexpr float kMostScore = 8;
/// After less than kQuietDb, what begins is no drum among others, and needs less of a score.
constexpr double kQuietDb = -70;
constexpr float kQuietLeast = -2;

float
score_of(std::span<const float> features)
{
  std::array<float, kOnsetMean.size()> scaled{};
  for (std::size_t i = 0; i < scaled.size(); i++)
    scaled[i] = std::clamp((features[i] - kOnsetMean[i]) * kOnsetScale[i], -4.0F, 4.0F);
  float score = kOnsetOffset;
  for (std::size_t unit = 0; unit < kOnsetOut.size(); unit++) {
    const auto weights = kOnsetHidden.begin() + static_cast<std::ptrdiff_t>(unit * scaled.size());
    const float sum
        = std::inner_product(scaled.begin(), scaled.end(), weights, kOnsetHiddenOffset[unit]);
    score += kOnsetOut[unit] * std::max(sum, 0.0F);
  }
  return std::clamp(score, -kMostScore, kMostScore);
}

bool
is_quiet(const Powers &powers)
{
  return decibels(std::accumulate(powers.begin(), powers.end(), 0.0)) < kQuietDb;
}

} // namespace

bool
OnsetDetector::add(const BandPowers &powers)
{
  const bool rises = features_.add(powers);
  std::shift_right(scores_.begin(), scores_.end(), 1);
  scores_[0] = rises ? score_of(features_.features()) : -kMostScore;
  dead_ = std::max(dead_ - 1, 0);
  const float mean
      = std::accumulate(scores_.begin(), scores_.end(), 0.0F) / static_cast<float>(scores_.size());
  if (!rises || dead_ > 0 || mean <= (is_quiet(before()) ? kQuietLeast : kOnsetLeast))
    return false;
  dead_ = kDeadHops;
  return true;
}

void
OnsetDetector::reset()
{
  features_.reset();
  scores_.fill(-kMostScore);
  dead_ = 0;
}

} // namespace sound
