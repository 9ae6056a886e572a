// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/sound_analyzer.h"

#include <algorithm>
#include <cmath>

namespace sound {

namespace {

constexpr double kHopS = 0.005;
/// Of power that is felt as 0 and as 1, dB of full scale.
constexpr double kFaintestDb = -50;
constexpr double kStrongestDb = -10;
/// A blow is over when its level is below this, but not before kLeastHops.
constexpr double kOver = 0.25;
constexpr int kLeastHops = 12;
/// A blow is loudest within this time, and over when it has fallen by 12 dB, or when what is heard
/// from 500 Hz to 4 kHz are tones: then it is a voice that sounded like a blow at first, or music.
constexpr int kAttackHops = 3;
constexpr double kFaded = 0.063;
constexpr double kTonal = 5.5; ///< mean BandPowers::uneven, dB
constexpr double kSmooth = 0.3;
/// A level falls to 0 within this time at the fastest.
constexpr double kFallS = 0.15;
/// Smoothing of rumble, and the weakest that is felt.
constexpr double kRumbleS = 0.08;
constexpr double kLeastRumbleDb = -36;
/// Below this share of what voices have, what is deep is taken for a part of them.
constexpr double kVoiceLeak = 0.05;

double
level_of(double power, double gain_db)
{
  const double db = 10 * std::log10(power + 1e-12) + gain_db;
  return std::clamp((db - kFaintestDb) / (kStrongestDb - kFaintestDb), 0.0, 1.0);
}

} // namespace

SoundAnalyzer::SoundAnalyzer(int rate, std::span<const Speaker> speakers)
    : speakers_(speakers.begin(), speakers.end()), has_rear_(sound::has_rear(speakers)),
      bands_(rate, speakers)
{
  delay_ = OnsetDetector::kAhead * kHopTime
           + std::chrono::ceil<Time>(std::chrono::duration<double>(bands_.delay()));
  moments_.reserve(256);
  reset();
}

Time
SoundAnalyzer::delay() const
{
  return delay_;
}

bool
SoundAnalyzer::has_rear() const
{
  return has_rear_;
}

void
SoundAnalyzer::reset()
{
  bands_.reset();
  detector_.reset();
  held_.fill({});
  newest_ = 0;
  hop_ = 0;
  blow_ = {};
  deep_.fill(0);
  voice_ = 0;
}

const BandPowers &
SoundAnalyzer::powers(int ago) const
{
  return held_[static_cast<std::size_t>((newest_ - ago + kHeld) % kHeld)];
}

std::span<const Moment>
SoundAnalyzer::add(std::span<const float> frames, const FeelSettings &settings)
{
  moments_.clear();
  const std::size_t block = Resampler::kBlock * speakers_.size();
  while (!frames.empty()) {
    const std::span<const float> some = frames.first(std::min(frames.size(), block));
    frames = frames.subspan(some.size());
    bands_.add(some);
    for (;;) {
      const int next = (newest_ + 1) % kHeld;
      if (!bands_.next(held_[static_cast<std::size_t>(next)]))
        break;
      newest_ = next;
      const bool onset = detector_.add(powers(0));
      if (hop_++ >= OnsetDetector::kAhead)
        moments_.push_back(analyze(onset, settings));
    }
  }
  return moments_;
}

Moment
SoundAnalyzer::analyze(bool onset, const FeelSettings &settings)
{
  Moment moment;
  moment.begin = (hop_ - 1 - OnsetDetector::kAhead) * kHopTime;
  moment.onset = onset && settings.blows;
  if (moment.onset)
    begin_blow();
  const double blow = feel_blow(settings);
  const double rumble = feel_rumble(settings);
  moment.level = static_cast<float>(std::max(blow, rumble));
  if (blow >= rumble)
    moment.place = blow_.place;
  else
    moment.place = place_of(speakers_, std::span(deep_).first(speakers_.size()), 1);
  return moment;
}

void
SoundAnalyzer::begin_blow()
{
  blow_ = { .lasts = true, .before = detector_.before() };
  std::array<double, kMaxSpeakers> rises{};
  for (std::size_t c = 0; c < speakers_.size(); c++)
    for (std::size_t band = 1; band < kBands; band++) {
      double now = 0;
      double before = 0;
      for (int ago = 0; ago <= OnsetDetector::kAhead; ago++)
        now = std::max(now, powers(ago).of[c][band]);
      for (int ago = OnsetDetector::kAhead + 2; ago < kHeld; ago++)
        before = std::max(before, powers(ago).of[c][band]);
      // Bands in which the blow stands out count most.
      rises[c] += std::max(0.0, now - before) / (blow_.before[band] + 1e-9);
    }
  blow_.place = place_of(speakers_, std::span(rises).first(speakers_.size()),
                         powers(OnsetDetector::kAhead - 1).likeness);
}

double
SoundAnalyzer::feel_blow(const FeelSettings &settings)
{
  if (!blow_.lasts)
    return 0;
  const Powers &now = powers(OnsetDetector::kAhead).sum;
  double excess = 0;
  for (std::size_t band = 0; band < kBands; band++) {
    // The loudest until now's analysis ends: a blow begins at once.
    double power = now[band];
    if (blow_.hops == 0)
      for (int ago = 0; ago < OnsetDetector::kAhead; ago++)
        power = std::max(power, powers(ago).sum[band]);
    excess += std::max(0.0, power - blow_.before[band]);
  }
  // It only fades: what gets louder after its begin is something else.
  if (blow_.hops < kAttackHops) {
    blow_.smooth = blow_.power = blow_.loudest = std::max(blow_.loudest, excess);
  } else {
    blow_.smooth += kSmooth * (excess - blow_.smooth);
    blow_.power = std::min(blow_.power, blow_.smooth);
  }
  blow_.level = std::max(level_of(blow_.power, settings.gain_db), blow_.level - kHopS / kFallS);
  const Powers &uneven = powers(OnsetDetector::kAhead).uneven;
  const bool is_tonal = (uneven[4] + uneven[5] + uneven[6]) / 3 > kTonal;
  const bool goes_on = blow_.power > kFaded * blow_.loudest && blow_.level >= kOver && !is_tonal;
  blow_.lasts = blow_.hops++ < kLeastHops || goes_on;
  return blow_.lasts ? std::max(blow_.level, kOver) : 0;
}

double
SoundAnalyzer::feel_rumble(const FeelSettings &settings)
{
  const double part = 1 - std::exp(-kHopS / kRumbleS);
  const BandPowers &now = powers(OnsetDetector::kAhead);
  double deep = 0;
  for (std::size_t c = 0; c < speakers_.size(); c++) {
    deep_[c] += part * (now.of[c][0] - deep_[c]);
    deep += deep_[c];
  }
  voice_ += part * (now.sum[2] + now.sum[3] + now.sum[4] - voice_);
  const double least = std::pow(10, (kLeastRumbleDb - settings.gain_db) / 10);
  return settings.rumble && deep > least && deep > kVoiceLeak * voice_
             ? level_of(deep, settings.gain_db)
             : 0;
}

} // namespace sound
