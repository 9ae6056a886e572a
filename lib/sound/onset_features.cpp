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
/// Least mean rise of a stroke, dB.
constexpr float kLeastStroke = 3;
/// A voiced sound has at least this voicing.
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

OnsetFeatures::OnsetFeatures(bool looks_ahead) : looks_ahead_(looks_ahead)
{
  reset();
}

const OnsetFeatures::Hop &
OnsetFeatures::hop(int ago) const
{
  return hops_[static_cast<std::size_t>((newest_ - ago + kHeld) % kHeld)];
}

const OnsetFeatures::Rise &
OnsetFeatures::ours() const
{
  return rises_[(newest_rise_ + (looks_ahead_ ? 1 : 0)) % rises_.size()];
}

bool
OnsetFeatures::add(const BandPowers &powers)
{
  follow(powers);
  known_ = std::min(known_ + 1, kHeld);
  newest_rise_ = (newest_rise_ + 1) % rises_.size();
  Rise &newest = rises_[newest_rise_];
  newest.is_any = compare(newest) && known_ > kPast;
  if (!looks_ahead_)
    return newest.is_any;
  Rise &oldest = rises_[(newest_rise_ + 1) % rises_.size()];
  if (oldest.is_any)
    compare_later(oldest);
  return oldest.is_any;
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
OnsetFeatures::compare(Rise &rise)
{
  Levels &now = rise.now;
  Levels &past = rise.past;
  now = hop(0).db;
  past = hop(kGap).db;
  std::array<float, kFine> fine_now = hop(0).fine;
  std::array<float, kFine> fine_past = hop(kGap).fine;
  for (int ago = 1; ago < kNow; ago++)
    for (std::size_t i = 0; i < kLevels; i++)
      now[i] = std::max(now[i], hop(ago).db[i]);
  for (int ago = 1; ago < kNow; ago++)
    for (std::size_t i = 0; i < kFine; i++)
      fine_now[i] = std::max(fine_now[i], hop(ago).fine[i]);
  for (int ago = kGap + 1; ago <= kPast; ago++) {
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
  Shape shape{};
  std::copy_n(now.begin(), kLowBands, shape.begin());
  std::ranges::copy(fine_now, shape.begin() + kLowBands);
  remember(shape);
  const float over_95 = flux - flux_95_;
  const float over_99 = flux - flux_99_;
  const float over_most = flux - flux_most_;
  follow_quantile(flux_95_, usual_flux, 0.95F, 0.1F);
  follow_quantile(flux_99_, usual_flux, 0.99F, 0.2F);
  flux_most_ = std::max(usual_flux, flux_most_ - 0.01F);
  if (flux < kLeastFlux)
    return false;

  float *out = rise.features.data();
  const Usual &usual = hop(kGap).usual;
  for (std::size_t i = 0; i < kLevels; i++)
    *out++ = std::clamp(now[i] - past[i], -6.0F, 30.0F);
  for (const Levels &of : { usual.half, usual.most, usual.nearly_all, usual.loudest })
    for (std::size_t i = 0; i < kLevels; i++)
      *out++ = std::clamp(now[i] - of[i], -30.0F, 40.0F);
  for (std::size_t i = 0; i < kBands; i++)
    *out++ = (hop(0).db[i] + hop(1).db[i]) / 2 - now[i];
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
    *out++ = static_cast<float>(std::clamp(
        std::min({ hop(kNow - 1).uneven[band], hop(kNow - 2).uneven[band], hop(0).uneven[band] }),
        0.0, 20.0));
  // Each band's rise against the greatest rise.
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
  for (int ago = kGap; ago <= kPast; ago++)
    voiced = std::max(voiced, hop(ago).voicing);
  *out++ = 10 * hop(0).voicing;
  *out++ = 10 * voiced;
  *out++ = 10 * hop(kGap).spoken;
  *out++ = 10 * hop(kNow - 1).voicing;
  *out++ = std::clamp(now[kWhole] - hop(kGap).loud_voice, -20.0F, 20.0F);
  compare_strokes(shape, out);

  rise.before.fill(0);
  for (int ago = kGap; ago <= kPast; ago++)
    for (std::size_t band = 0; band < kBands; band++)
      rise.before[band] = std::max(rise.before[band], hop(ago).power[band]);
  return true;
}

/// How it goes on.
void
OnsetFeatures::compare_later(Rise &rise) const
{
  Levels soon{};
  Levels late{};
  Levels most{};
  most.fill(kFloor);
  float voicing = 0;
  double uneven = 0;
  for (int ago = 0; ago < kLater; ago++) {
    for (std::size_t i = 0; i < kLevels; i++) {
      const float db = hop(ago).db[i];
      soon[i] += ago >= kLater - 5 ? db / 5 : 0;
      late[i] += ago < 8 ? db / 8 : 0;
      most[i] = std::max(most[i], db);
    }
    voicing += hop(ago).voicing / kLater;
    uneven += (hop(ago).uneven[4] + hop(ago).uneven[5] + hop(ago).uneven[6]) / 3 / kLater;
  }
  float *out = rise.features.data() + kCount;
  Levels long_ago = hop(kLongAgo).db;
  for (int ago = kLongAgo + 1; ago < kHeld; ago++)
    for (std::size_t i = 0; i < kLevels; i++)
      long_ago[i] = std::max(long_ago[i], hop(ago).db[i]);
  for (std::size_t i = 0; i < kLevels; i++)
    *out++ = std::clamp(rise.now[i] - long_ago[i], -10.0F, 40.0F);
  *out++ = std::clamp(rise.now[kWhole] - rise.past[kWhole], 0.0F, 60.0F);
  for (std::size_t i = 0; i < kLevels; i++) {
    *out++ = std::clamp(soon[i] - rise.now[i], -40.0F, 20.0F);
    *out++ = std::clamp(late[i] - rise.now[i], -40.0F, 20.0F);
    *out++ = std::clamp(most[i] - rise.past[i], -10.0F, 40.0F);
  }
  *out++ = 10 * voicing;
  *out++ = static_cast<float>(std::min(uneven, 20.0));
  *out++ = *std::max_element(fluxes_.begin(), fluxes_.begin() + 11);
}

/// The greatest rise within 50 ms is a stroke, once it is over.
void
OnsetFeatures::remember(const Shape &shape)
{
  std::shift_right(shapes_.begin(), shapes_.end(), 1);
  shapes_[0] = shape;
  const float flux = fluxes_[kGap];
  if (flux < kLeastStroke || std::ranges::max(fluxes_) > flux)
    return;
  strokes_[newest_stroke_ % kStrokes] = shapes_[kGap];
  newest_stroke_++;
}

/// How unlike the last strokes it is: drums repeat theirs.
void
OnsetFeatures::compare_strokes(const Shape &shape, float *out) const
{
  std::array<float, kStrokes> unlike{};
  unlike.fill(20);
  Shape most{};
  most.fill(kFineFloor);
  const std::size_t count = std::min(newest_stroke_, kStrokes);
  for (std::size_t i = 0; i < count; i++) {
    float sum = 0;
    for (std::size_t k = 0; k < shape.size(); k++) {
      sum += std::abs(shape[k] - strokes_[i][k]);
      most[k] = std::max(most[k], strokes_[i][k]);
    }
    unlike[i] = std::min(sum / static_cast<float>(shape.size()), 20.0F);
  }
  const auto nearest = static_cast<std::size_t>(std::ranges::min_element(unlike) - unlike.begin());
  float louder = 0;
  float weaker = 0;
  float excess = 0;
  float bands = 0;
  for (std::size_t k = 0; k < shape.size(); k++) {
    const float more = count > 0 ? std::clamp(shape[k] - strokes_[nearest][k], -20.0F, 20.0F) : 20;
    louder += std::max(more, 0.0F) / static_cast<float>(shape.size());
    weaker += std::max(-more, 0.0F) / static_cast<float>(shape.size());
    const float over = std::clamp(shape[k] - most[k], 0.0F, 20.0F);
    excess += over / static_cast<float>(shape.size());
    bands += over > 3 ? 1.0F : 0.0F;
  }
  std::ranges::nth_element(unlike, unlike.begin() + 3);
  *out++ = *std::min_element(unlike.begin(), unlike.begin() + 4);
  *out++ = unlike[3];
  *out++ = louder;
  *out++ = weaker;
  *out++ = excess;
  *out++ = bands;
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
  shapes_.fill({});
  flux_95_ = flux_99_ = flux_most_ = 0;
  newest_stroke_ = 0;
  rises_.fill({});
}

} // namespace sound
