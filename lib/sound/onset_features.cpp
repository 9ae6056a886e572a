// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/onset_features.h"

#include "sound/level.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sound {

namespace {

/// First bins of the fine bands, and the end.
constexpr std::array<std::size_t, 13> kFineBins{ 2, 3, 4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 112 };
constexpr float kFineFloor = -85; ///< dB
/// Least mean rise of all fine bands, dB.
constexpr float kLeastFlux = 1;
/// What of a sound is voiced has at least this voicing.
constexpr float kVoiced = 0.8F;
/// A hop's part of half a second.
constexpr float kForgotten = 0.01F;
/// The loudest vowel, and the loudest sound, are forgotten by so much a hop, dB.
constexpr float kVoiceFades = 0.05F;
constexpr float kLoudestFades = 0.03F;

/// Follows the level below which a sound is for `part` of the time, by `rate` dB a hop.
void
follow_quantile(float &quantile, float level, float part, float rate)
{
  quantile += level > quantile ? rate * part : -rate * (1 - part);
}

} // namespace

OnsetFeatures::OnsetFeatures(bool waits) : later_(waits ? kLater : 0)
{
  reset();
}

const OnsetFeatures::Hop &
OnsetFeatures::hop(int ago) const
{
  return hops_[static_cast<std::size_t>((newest_ - ago + kHeld) % kHeld)];
}

bool
OnsetFeatures::add(const BandPowers &powers)
{
  follow(powers);
  known_ = std::min(known_ + 1, kHeld);
  return compare() && known_ > kPast + later_;
}

void
OnsetFeatures::follow(const BandPowers &powers)
{
  const int last_index = newest_;
  newest_ = (newest_ + 1) % kHeld;
  const Hop &last = hops_[static_cast<std::size_t>(last_index)];
  Hop &now = hops_[static_cast<std::size_t>(newest_)];
  now.power = powers.sum;
  now.uneven = powers.uneven;
  for (std::size_t band = 0; band < kBands; band++)
    now.db[band] = std::max(static_cast<float>(decibels(powers.sum[band])), kFloor);
  now.db[kWhole] = std::max(
      static_cast<float>(decibels(std::accumulate(now.power.begin(), now.power.end(), 0.0))),
      kFloor);
  for (std::size_t i = 0; i < kFine; i++) {
    const auto from = powers.bins.begin() + static_cast<std::ptrdiff_t>(kFineBins[i]);
    const auto to = powers.bins.begin() + static_cast<std::ptrdiff_t>(kFineBins[i + 1]);
    now.fine[i]
        = std::max(std::accumulate(from, to, 0.0F) / static_cast<float>(to - from), kFineFloor);
  }
  now.usual = last.usual;
  for (std::size_t i = 0; i < kLevels; i++) {
    const float db = now.db[i];
    follow_quantile(now.usual.half[i], db, 0.5F, 0.15F);
    follow_quantile(now.usual.most[i], db, 0.9F, 0.25F);
    follow_quantile(now.usual.nearly_all[i], db, 0.98F, 0.6F);
    now.usual.loudest[i] = std::max(db, last.usual.loudest[i] - kLoudestFades);
  }
  now.voicing = static_cast<float>(powers.voicing);
  now.spoken = last.spoken
               + kForgotten * (std::clamp((now.voicing - 0.5F) / 0.4F, 0.0F, 1.0F) - last.spoken);
  now.loud_voice = std::max(
      { now.voicing > kVoiced ? now.db[kWhole] : kFloor, last.loud_voice - kVoiceFades, kFloor });
}

bool
OnsetFeatures::compare()
{
  Levels now = hop(later_).db;
  Levels past = hop(later_ + kGap).db;
  std::array<float, kFine> fine_now = hop(later_).fine;
  std::array<float, kFine> fine_past = hop(later_ + kGap).fine;
  for (int ago = later_ + 1; ago < later_ + kNow; ago++)
    for (std::size_t i = 0; i < kLevels; i++)
      now[i] = std::max(now[i], hop(ago).db[i]);
  for (int ago = later_ + 1; ago < later_ + kNow; ago++)
    for (std::size_t i = 0; i < kFine; i++)
      fine_now[i] = std::max(fine_now[i], hop(ago).fine[i]);
  for (int ago = later_ + kGap + 1; ago <= later_ + kPast; ago++) {
    for (std::size_t i = 0; i < kLevels; i++)
      past[i] = std::max(past[i], hop(ago).db[i]);
    for (std::size_t i = 0; i < kFine; i++)
      fine_past[i] = std::max(fine_past[i], hop(ago).fine[i]);
  }

  // How much each of 14 bands rises.
  std::array<float, kLowBands + kFine> rises{};
  for (std::size_t i = 0; i < kLowBands; i++)
    rises[i] = std::clamp(now[i] - past[i], 0.0F, 20.0F);
  for (std::size_t i = 0; i < kFine; i++)
    rises[kLowBands + i] = std::clamp(fine_now[i] - fine_past[i], 0.0F, 20.0F);
  const float flux
      = std::accumulate(rises.begin(), rises.end(), 0.0F) / static_cast<float>(rises.size());
  const float usual_flux = fluxes_[kGap - 1];
  std::shift_right(fluxes_.begin(), fluxes_.end(), 1);
  fluxes_[0] = flux;
  const float over_95 = flux - flux_95_;
  const float over_99 = flux - flux_99_;
  const float over_most = flux - flux_most_;
  follow_quantile(flux_95_, usual_flux, 0.95F, 0.1F);
  follow_quantile(flux_99_, usual_flux, 0.99F, 0.2F);
  flux_most_ = std::max(usual_flux, flux_most_ - 0.01F);
  if (flux < kLeastFlux)
    return false;

  float *out = features_.data();
  const Usual &usual = hop(later_ + kGap).usual;
  for (std::size_t i = 0; i < kLevels; i++)
    *out++ = std::clamp(now[i] - past[i], -6.0F, 30.0F);
  for (const Levels &of : { usual.half, usual.most, usual.nearly_all, usual.loudest })
    for (std::size_t i = 0; i < kLevels; i++)
      *out++ = std::clamp(now[i] - of[i], -30.0F, 40.0F);
  for (std::size_t i = 0; i < kBands; i++)
    *out++ = (hop(later_).db[i] + hop(later_ + 1).db[i]) / 2 - now[i];
  out = std::copy(rises.begin(), rises.end(), out);
  *out++ = flux;
  const auto share = [&](float least) {
    return static_cast<float>(
        std::ranges::count_if(rises, [&](float rise) { return rise > least; }));
  };
  *out++ = share(6);
  *out++ = share(3);
  *out++ = over_95;
  *out++ = over_99;
  *out++ = over_most;
  for (std::size_t band = kLowBands; band < kBands; band++)
    *out++ = static_cast<float>(
        std::clamp(std::min({ hop(later_ + kNow - 1).uneven[band],
                              hop(later_ + kNow - 2).uneven[band], hop(later_).uneven[band] }),
                   0.0, 20.0));
  // What is louder than before, of each band against the most of them.
  std::array<float, kBands> excess{};
  for (std::size_t i = 0; i < kBands; i++)
    excess[i] = static_cast<float>(
        decibels(std::max(0.0, std::pow(10, now[i] / 10) - std::pow(10, past[i] / 10)) + 1e-8));
  const float largest = *std::ranges::max_element(excess);
  float center = 0;
  float sum = 0;
  for (std::size_t i = 0; i < kBands; i++) {
    *out++ = std::max(excess[i] - largest, -40.0F);
    const float weight = std::pow(10.0F, (excess[i] - largest) / 20);
    center += static_cast<float>(i) * weight;
    sum += weight;
  }
  *out++ = center / sum;
  float voiced = 0;
  for (int ago = later_ + kGap; ago <= later_ + kPast; ago++)
    voiced = std::max(voiced, hop(ago).voicing);
  *out++ = 10 * hop(later_).voicing;
  *out++ = 10 * voiced;
  *out++ = 10 * hop(later_ + kGap).spoken;
  *out++ = 10 * hop(later_ + kNow - 1).voicing;
  *out++ = std::clamp(now[kWhole] - hop(later_ + kGap).loud_voice, -20.0F, 20.0F);
  if (later_ > 0)
    add_later(now, out);

  before_.fill(0);
  for (int ago = later_ + kGap; ago <= later_ + kPast; ago++)
    for (std::size_t band = 0; band < kBands; band++)
      before_[band] = std::max(before_[band], hop(ago).power[band]);
  return true;
}

/// How it fades, whether it becomes a tone, and what else rises.
void
OnsetFeatures::add_later(const Levels &now, float *out) const
{
  constexpr int kThird = 5; // hops
  for (int part = 0; part < 3; part++) {
    const int newest = kLater - 1 - (part + 1) * kThird;
    for (std::size_t i = 0; i < kLevels; i++) {
      float mean = 0;
      for (int ago = newest; ago < newest + kThird; ago++)
        mean += hop(std::max(ago, 0)).db[i] / kThird;
      *out++ = std::clamp(mean - now[i], -40.0F, 20.0F);
    }
  }
  float voiced = 0;
  for (int ago = 0; ago < kLater; ago++)
    voiced = std::max(voiced, hop(ago).voicing);
  *out++ = 10 * voiced;
  *out++ = 10 * hop(kLater / 2).voicing;
  for (std::size_t band = kLowBands; band < kBands; band++) {
    double mean = 0;
    for (int ago = 0; ago < kLater; ago++)
      mean += hop(ago).uneven[band] / kLater;
    *out++ = static_cast<float>(mean);
  }
  *out++ = std::clamp(hop(0).db[kWhole] - hop(later_ + kGap).db[kWhole], -20.0F, 40.0F);
}

void
OnsetFeatures::reset()
{
  known_ = 0;
  Hop silence;
  silence.db.fill(kFloor);
  silence.fine.fill(kFineFloor);
  for (Levels *usual : { &silence.usual.half, &silence.usual.most, &silence.usual.nearly_all,
                         &silence.usual.loudest })
    usual->fill(kFloor);
  hops_.fill(silence);
  fluxes_.fill(0);
  flux_95_ = flux_99_ = flux_most_ = 0;
}

} // namespace sound
