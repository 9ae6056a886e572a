// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/onset_features.h"

#include "sound/level.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sound {

namespace {

constexpr double kFloor = -70; ///< dB; what is below counts as that
constexpr double kFilledFloor = -85;
constexpr double kExcessFloor = 1e-7;
/// Least mean rise of the upper octaves, dB.
constexpr double kLeastRise = 4;
/// More than this a bin does not count, dB.
constexpr float kRisen = 8;
/// What of a sound is voiced has at least this voicing.
constexpr double kVoiced = 0.8;
/// A hop's part of half a second.
constexpr double kForgotten = 0.01;
/// The loudest sound is forgotten by so much a hop, dB.
constexpr double kFadedDb = 0.05;

} // namespace

const OnsetFeatures::Hop &
OnsetFeatures::hop(int ago) const
{
  return hops_[static_cast<std::size_t>((newest_ - ago + kHeld) % kHeld)];
}

bool
OnsetFeatures::add(const BandPowers &powers)
{
  newest_ = (newest_ + 1) % kHeld;
  known_ = std::min(known_ + 1, kHeld);
  Hop &now = hops_[static_cast<std::size_t>(newest_)];
  now.power = powers.sum;
  now.bins = powers.bins;
  for (std::size_t band = 0; band < kBands; band++) {
    now.db[band] = std::max(decibels(powers.sum[band]), kFloor);
    now.filled[band] = std::max(powers.filled[band], kFilledFloor);
    now.uneven[band] = powers.uneven[band];
  }
  follow_voices(powers.voicing);
  return known_ == kHeld && compare();
}

void
OnsetFeatures::follow_voices(double voicing)
{
  Hop &now = hops_[static_cast<std::size_t>(newest_)];
  const Hop &last = hop(1);
  now.voicing = voicing;
  now.whole
      = std::max(decibels(std::accumulate(now.power.begin(), now.power.end(), 0.0)), kWholeFloor);
  now.spoken
      = last.spoken + kForgotten * (std::clamp((voicing - 0.5) / 0.4, 0.0, 1.0) - last.spoken);
  now.loudest = std::max({ now.whole, last.loudest - kFadedDb, kWholeFloor });
  now.loud_voice = std::max(
      { voicing > kVoiced ? now.whole : kWholeFloor, last.loud_voice - kFadedDb, kWholeFloor });
}

bool
OnsetFeatures::compare()
{
  constexpr int kMoment = kAhead;
  Powers rise{};
  Powers excess{};
  Powers fuller{};
  Powers uneven{};
  Powers sudden{};
  Powers longer{};
  before_.fill(0);
  for (std::size_t band = 0; band < kBands; band++) {
    double db = kFloor;
    double filled = kFloor;
    for (int ago = kMoment + kGap; ago <= kMoment + kPast; ago++) {
      db = std::max(db, hop(ago).db[band]);
      filled = std::max(filled, hop(ago).filled[band]);
      before_[band] = std::max(before_[band], hop(ago).power[band]);
    }
    const Hop &moment = hop(kMoment);
    const Hop &after = hop(kMoment - 1);
    const double loudest = std::max({ moment.db[band], after.db[band], hop(kMoment - 2).db[band] });
    const double fullest = std::max(moment.filled[band], after.filled[band]);
    rise[band] = std::clamp(loudest - db, -3.0, 15.0);
    excess[band] = std::max(0.0, std::pow(10, loudest / 10) - std::pow(10, db / 10)) + kExcessFloor;
    fuller[band] = std::clamp(fullest - filled, -3.0, 20.0);
    uneven[band] = std::clamp(std::min(moment.uneven[band], after.uneven[band]), 0.0, 20.0);
    sudden[band] = std::clamp(
        fullest - (hop(kMoment + 1).filled[band] + hop(kMoment + 2).filled[band]) / 2, -3.0, 15.0);
    double sum = 0;
    for (int ago = kMoment + kLongGap; ago <= kMoment + kLongPast; ago++)
      sum += hop(ago).filled[band];
    longer[band] = std::clamp(fullest - sum / (kLongPast - kLongGap + 1), -3.0, 30.0);
  }
  if ((fuller[5] + fuller[6] + fuller[7]) / 3 <= kLeastRise)
    return false;
  const auto ratio = [](double a, double b) {
    return std::clamp(decibels(a / b), -20.0, 10.0);
  };
  const Powers risen = risen_bins();
  const double middle = excess[2] + excess[3] + excess[4];
  auto *out = features_.begin();
  out = std::copy(rise.begin(), rise.end(), out);
  for (const Powers &of : { fuller, uneven, sudden, longer, risen })
    out = std::copy(of.begin() + kLowBands, of.end(), out);
  *out++ = ratio(excess[0] + excess[1], middle);
  *out++ = ratio(excess[6] + excess[7], middle);
  *out++ = ratio(excess[0], excess[1] + excess[2]);
  double voiced = 0;
  for (int ago = kMoment + kGap; ago <= kMoment + kPast; ago++)
    voiced = std::max(voiced, hop(ago).voicing);
  const Hop &before = hop(kMoment + kGap);
  const double whole
      = std::max({ hop(kMoment).whole, hop(kMoment - 1).whole, hop(kMoment - 2).whole });
  *out++ = 10 * hop(0).voicing;
  *out++ = 10 * voiced;
  *out++ = 10 * before.spoken;
  *out++ = std::clamp(whole - before.loudest, -20.0, 20.0);
  *out++ = std::clamp(whole - before.loud_voice, -20.0, 20.0);
  return true;
}

Powers
OnsetFeatures::risen_bins() const
{
  BinLevels past = hop(kAhead + kGap).bins;
  for (int ago = kAhead + kGap + 1; ago <= kAhead + kPast; ago++)
    for (std::size_t bin = kOctaves.front(); bin < kOctaves.back(); bin++)
      past[bin] = std::max(past[bin], hop(ago).bins[bin]);
  Powers risen{};
  for (std::size_t octave = 0; octave + 1 < kOctaves.size(); octave++) {
    float sum = 0;
    for (std::size_t bin = kOctaves[octave]; bin < kOctaves[octave + 1]; bin++)
      sum += std::clamp(std::max(hop(kAhead).bins[bin], hop(kAhead - 1).bins[bin]) - past[bin],
                        0.0F, kRisen);
    risen[octave + kLowBands]
        = static_cast<double>(sum) / static_cast<double>(kOctaves[octave + 1] - kOctaves[octave]);
  }
  return risen;
}

const Features &
OnsetFeatures::features() const
{
  return features_;
}

const Powers &
OnsetFeatures::before() const
{
  return before_;
}

void
OnsetFeatures::reset()
{
  known_ = 0;
  hops_.fill({});
}

} // namespace sound
