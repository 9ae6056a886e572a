// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/sound_analyzer.h"

#include "sound/level.h"

#include <algorithm>
#include <cmath>

namespace sound {

namespace {

constexpr double kHopS = 0.005;
/// An impact is over when its level is below this, but not before kLeastHops.
constexpr double kOver = 0.1;
constexpr int kLeastHops = 12;
/// An impact is loudest within this time (explosions rise in 76 ms), and over when it has fallen by
/// 12 dB, or when 500 Hz to 4 kHz are tonal: then it is music, or a voice that resembled an impact
/// at first.
constexpr int kAttackHops = 16;
constexpr double kFaded = 0.063;
constexpr double kTonal = 5.5; ///< mean BandPowers::uneven, dB
constexpr double kSmooth = 0.3;
/// A level falls to 0 within this time at the fastest.
constexpr double kFallS = 0.15;

} // namespace

SoundAnalyzer::SoundAnalyzer(int rate, std::span<const Speaker> speakers, bool looks_ahead)
    : speakers_(speakers.begin(), speakers.end()), has_rear_(sound::has_rear(speakers)),
      bands_(rate, speakers), detector_(looks_ahead), rumble_(speakers)
{
  delay_ = detector_.ahead() * kHopTime
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
  impact_ = {};
  rumble_.reset();
  impact_pitch_.reset();
  rumble_pitch_.reset();
  loudness_.reset();
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
      const bool onset = detector_.add(powers(0), settings.surer);
      if (hop_++ >= detector_.ahead())
        moments_.push_back(analyze(onset, settings));
    }
  }
  return moments_;
}

Moment
SoundAnalyzer::analyze(bool onset, const FeelSettings &settings)
{
  const int ahead = detector_.ahead();
  Moment moment;
  moment.begin = (hop_ - 1 - ahead) * kHopTime;
  moment.onset = onset && settings.impacts;
  if (moment.onset)
    begin_impact();
  const double gain_db = settings.gain_db + loudness_.add(powers(ahead));
  const double impact = feel_impact(gain_db);
  const double heard = rumble_.add(powers(ahead), gain_db);
  const double rumble = settings.rumble ? heard : 0;
  moment.level = static_cast<float>(std::max(impact, rumble));
  const float deep = rumble_pitch_.add(powers(ahead), { powers(ahead).sum[0] });
  if (impact >= rumble) {
    moment.place = impact_.place;
    moment.frequency = impact_.frequency;
  } else {
    moment.place = place_of(speakers_, rumble_.powers(), 1);
    moment.frequency = deep;
  }
  return moment;
}

void
SoundAnalyzer::begin_impact()
{
  impact_ = { .lasts = true, .before = detector_.before() };
  impact_pitch_.reset();
  const int newest = detector_.ahead() - OnsetFeatures::kAhead;
  std::array<double, kMaxSpeakers> rises{};
  for (std::size_t c = 0; c < speakers_.size(); c++)
    for (std::size_t band = 1; band < kBands; band++) {
      double now = 0;
      double before = 0;
      for (int ago = newest; ago < newest + OnsetFeatures::kNow; ago++)
        now = std::max(now, powers(ago).of[c][band]);
      for (int ago = newest + OnsetFeatures::kGap; ago <= newest + OnsetFeatures::kPast; ago++)
        before = std::max(before, powers(ago).of[c][band]);
      // Bands in which the impact stands out count most.
      rises[c] += std::max(0.0, now - before) / (impact_.before[band] + 1e-9);
    }
  impact_.place = place_of(speakers_, std::span(rises).first(speakers_.size()),
                           powers(detector_.ahead() - 1).likeness);
}

double
SoundAnalyzer::feel_impact(double gain_db)
{
  if (!impact_.lasts)
    return 0;
  const int ahead = detector_.ahead();
  double excess = 0;
  for (std::size_t band = 0; band < kBands; band++) {
    double power = powers(ahead).sum[band];
    // All that the detector took for its begin.
    if (impact_.hops == 0)
      for (int ago = 0; ago < OnsetFeatures::kNow; ago++)
        power = std::max(power, powers(ahead - OnsetFeatures::kAhead + ago).sum[band]);
    impact_.excess[band] = std::max(0.0, power - impact_.before[band]);
    excess += impact_.excess[band];
  }
  if (impact_.hops < kAttackHops)
    impact_.frequency = impact_pitch_.add(powers(ahead), impact_.excess);
  // Then it only fades: what gets louder is something else.
  if (impact_.hops < kAttackHops) {
    impact_.smooth = impact_.power = impact_.loudest = std::max(impact_.loudest, excess);
  } else {
    impact_.smooth += kSmooth * (excess - impact_.smooth);
    impact_.power = std::min(impact_.power, impact_.smooth);
  }
  impact_.level = std::max(level_of(impact_.power, gain_db), impact_.level - kHopS / kFallS);
  const Powers &uneven = powers(ahead).uneven;
  const bool is_tonal = (uneven[4] + uneven[5] + uneven[6]) / 3 > kTonal;
  const bool goes_on
      = impact_.power > kFaded * impact_.loudest && impact_.level >= kOver && !is_tonal;
  impact_.lasts = impact_.hops++ < kLeastHops || goes_on;
  return impact_.lasts ? std::max(impact_.level, kOver) : 0;
}

} // namespace sound
