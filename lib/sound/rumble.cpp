// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/rumble.h"

#include "sound/level.h"
#include "sound/rumble_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sound {

namespace {

constexpr double kHopS = 0.005;
constexpr double kSmoothS = 0.08;
/// The weakest that is felt, dB of full scale.
constexpr double kLeastDb = -36;
/// Once it is rumble, its score may fall so low; lower while it only fades, within so many dB, by
/// so many dB in a hop at least.
constexpr float kHolds = -1;
/// Scores are at most this, and smoothed: in a moment alone, music is like rumble, too.
constexpr float kMostScore = 8;
constexpr double kScoreS = 0.4;
constexpr double kUnknown = -2;
constexpr double kFadesDb = 3;
constexpr double kFadingDb = 0.06;
/// Beside an equally loud vowel, rumble must be within 3 dB of the power from 65 Hz to 1 kHz, then
/// within 5 dB, and last this long: a puff of breath into a microphone lasts 20 to 100 ms.
constexpr int kLeastHops = 40;
constexpr double kOverMiddle = 2;
constexpr double kHoldsMiddle = 3.2;
constexpr double kVoiced = 0.8;       ///< voicing of vowels
constexpr double kForgotten = 0.9886; ///< of a vowel's power in a hop: 10 dB a second
/// Rumble lasts until its quick power is so far below its slow power, dB.
constexpr double kQuickS = 0.02;
constexpr double kOverDb = -12;
/// Times in which the floor follows a louder and a weaker sound; silence counts as kSilenceDb.
constexpr double kRiseS = 10;
constexpr double kFallS = 2;
constexpr double kSilenceDb = -70;
/// Levels above the floor from which on rumble is felt at all, and in full, dB.
constexpr double kOutDb = 3;
constexpr double kFullDb = 12;

double
share_in(double seconds)
{
  return 1 - std::exp(-kHopS / seconds);
}

/// How much it is like engines and thunder, and not like music and voices: above 0 if more.
float
score_of(std::span<const float> features)
{
  std::array<float, kRumbleMean.size()> scaled{};
  for (std::size_t i = 0; i < scaled.size(); i++)
    scaled[i] = std::clamp((features[i] - kRumbleMean[i]) * kRumbleScale[i], -3.0F, 3.0F);
  float score = kRumbleOffset;
  for (std::size_t unit = 0; unit < kRumbleOut.size(); unit++) {
    const float sum
        = std::inner_product(scaled.begin(), scaled.end(), &kRumbleHidden[unit * scaled.size()],
                             kRumbleHiddenOffset[unit]);
    score += kRumbleOut[unit] * std::max(sum, 0.0F);
  }
  return std::clamp(score, -kMostScore, kMostScore);
}

} // namespace

Rumble::Rumble(std::span<const Speaker> speakers)
{
  for (const Speaker &speaker : speakers)
    is_low_.push_back(speaker.role == Speaker::Role::low);
  reset();
}

double
Rumble::add(const BandPowers &powers, double gain_db)
{
  const double part = share_in(kSmoothS);
  double deep = 0;
  double effects = 0;
  quick_ += share_in(kQuickS) * (powers.sum[0] - quick_);
  for (std::size_t c = 0; c < is_low_.size(); c++) {
    deep_[c] += part * (powers.of[c][0] - deep_[c]);
    deep += deep_[c];
    effects += is_low_[c] ? deep_[c] : 0;
  }
  middle_ += part * (powers.sum[1] + powers.sum[2] + powers.sum[3] + powers.sum[4] - middle_);
  score_ += share_in(kScoreS) * (score_of(features_.add(powers).subspan(1)) - score_);
  const double heard = std::max(decibels(deep), kSilenceDb);
  // Another sound does not end an explosion that dies away.
  fading_ = score_ > kHolds ? heard : std::min(fading_ - kFadingDb, heard);
  is_rumble_ = score_ > 0 || (is_rumble_ && heard < fading_ + kFadesDb);
  floor_ += share_in(heard > floor_ ? kRiseS : kFallS) * (heard - floor_);
  vowel_ *= kForgotten;
  if (powers.voicing > kVoiced)
    vowel_ = std::max(vowel_, middle_);
  const bool goes_on
      = is_rumble_ && decibels(deep) + gain_db >= kLeastDb
        && (vowel_ < deep || middle_ < (is_felt_ ? kHoldsMiddle : kOverMiddle) * deep);
  lasted_ = goes_on && decibels(quick_) - decibels(deep) > kOverDb ? lasted_ + 1 : 0;
  is_felt_ = goes_on && (is_felt_ || lasted_ >= kLeastHops || vowel_ < deep);
  const double felt = is_felt_ ? deep : effects;
  if (decibels(felt) + gain_db < kLeastDb)
    return 0;
  const double out = (decibels(felt) - floor_ - kOutDb) / (kFullDb - kOutDb);
  return level_of(felt, gain_db) * std::clamp(out, 0.0, 1.0);
}

std::span<const double>
Rumble::powers() const
{
  return std::span(deep_).first(is_low_.size());
}

void
Rumble::reset()
{
  features_.reset();
  deep_.fill(0);
  score_ = kUnknown;
  quick_ = 0;
  middle_ = 0;
  vowel_ = 0;
  lasted_ = 0;
  fading_ = kSilenceDb;
  floor_ = kSilenceDb;
  is_rumble_ = false;
  is_felt_ = false;
}

} // namespace sound
