// SPDX-License-Identifier: LGPL-2.1-or-later
#include "impacts.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>

std::vector<gint64>
Impacts::add(gint64 time, std::span<const gint16> samples, int rate, int channels)
{
  using std::chrono::milliseconds;
  constexpr gint64 kJump = 50; // ms; less is the rounding of time stamps
  constexpr float kFullScale = 32768;
  std::vector<gint64> impacts;
  if (rate < sound::SoundAnalyzer::kLowestRate || rate > sound::SoundAnalyzer::kHighestRate
      || channels < 1 || channels > sound::kMaxSpeakers)
    return impacts;
  if (!analyzer_ || rate != rate_ || channels != channels_
      || std::abs(begin_ + frames_ * 1000 / rate - time) > kJump) {
    analyzer_.emplace(rate, sound::usual_speakers(channels));
    rate_ = rate;
    channels_ = channels;
    begin_ = time;
    frames_ = 0;
  }
  std::vector<float> floats(samples.size());
  std::ranges::transform(samples, floats.begin(),
                         [](gint16 sample) { return static_cast<float>(sample) / kFullScale; });
  frames_ += static_cast<gint64>(samples.size()) / channels;
  for (const sound::Moment &moment : analyzer_->add(floats, {}))
    if (moment.onset)
      impacts.push_back(begin_ + (moment.begin + sound::kHopTime / 2) / milliseconds(1));
  return impacts;
}
