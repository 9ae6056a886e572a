// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/onset_detector.h"

#include "sound/onset_weights.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace sound {

namespace {

/// One hidden layer.
struct OnsetNetwork
{
  std::span<const float> mean;
  std::span<const float> scale;
  std::span<const std::int8_t> hidden;
  std::span<const float> hidden_scale;
  std::span<const float> hidden_offset;
  std::span<const float> out;
  float offset;
  float least; ///< the mean score of an impact is above
};

constexpr OnsetNetwork kSoon{ kOnsetMean,         kOnsetScale, kOnsetHidden, kOnsetHiddenScale,
                              kOnsetHiddenOffset, kOnsetOut,   kOnsetOffset, kOnsetLeast };
constexpr OnsetNetwork kLater{ kLaterMean,         kLaterScale, kLaterHidden, kLaterHiddenScale,
                               kLaterHiddenOffset, kLaterOut,   kLaterOffset, kLaterLeast };

constexpr float kMostScore = 8;
/// A sound that rises far above all before it is no drum among others. From kStandsOut to
/// kStandsAlone, in dB, it needs ever less of a score, up to kAlone less.
constexpr float kStandsOut = 15;
constexpr float kStandsAlone = 40;
constexpr float kAlone = 4;

float
score_of(const OnsetNetwork &network, std::span<const float> features)
{
  std::array<float, OnsetFeatures::kCount + OnsetFeatures::kLaterCount> scaled{};
  for (std::size_t i = 0; i < features.size(); i++)
    scaled[i] = std::clamp((features[i] - network.mean[i]) * network.scale[i], -4.0F, 4.0F);
  float score = network.offset;
  const std::size_t count = features.size();
  for (std::size_t unit = 0; unit < network.out.size(); unit++) {
    const float sum
        = std::inner_product(scaled.begin(), scaled.begin() + static_cast<std::ptrdiff_t>(count),
                             &network.hidden[unit * count], 0.0F);
    score += network.out[unit]
             * std::max(network.hidden_scale[unit] * sum + network.hidden_offset[unit], 0.0F);
  }
  return std::clamp(score, -kMostScore, kMostScore);
}

float
alone(float rise_db)
{
  return kAlone * std::clamp((rise_db - kStandsOut) / (kStandsAlone - kStandsOut), 0.0F, 1.0F);
}

} // namespace

OnsetDetector::OnsetDetector(bool looks_ahead) : features_(looks_ahead)
{
  reset();
}

float
OnsetDetector::score() const
{
  const std::span<const float> features = features_.features();
  const float soon = score_of(kSoon, features.first(kSoon.mean.size()));
  return looks_ahead() ? (soon + score_of(kLater, features)) / 2 : soon;
}

bool
OnsetDetector::add(const BandPowers &powers, float more)
{
  const bool rises = features_.add(powers);
  std::shift_right(scores_.begin(), scores_.end(), 1);
  scores_[0] = rises ? score() : -kMostScore;
  dead_ = std::max(dead_ - 1, 0);
  const float least = looks_ahead() ? kLater.least : kSoon.least;
  const float mean
      = std::accumulate(scores_.begin(), scores_.end(), 0.0F) / static_cast<float>(scores_.size());
  if (!rises || dead_ > 0 || mean + alone(features_.rise_db()) <= least + more)
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
