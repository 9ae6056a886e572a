// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/bands.h"

#include <algorithm>
#include <cmath>

namespace sound {

Bands::Bands(int rate, std::span<const Speaker> speakers)
    : resampler_(rate, static_cast<int>(speakers.size())), channels_(speakers.size()),
      frame_(speakers.size()),
      bins_(static_cast<std::size_t>(Resampler::kPassed * std::min(rate, kRate) / Spectrum::kBinHz))
{
  for (int i = 0; i < std::ssize(speakers); i++) {
    const Speaker &speaker = speakers[static_cast<std::size_t>(i)];
    if (speaker.role != Speaker::Role::place || speaker.behind > 0)
      continue;
    if (speaker.across < 0 && left_ < 0)
      left_ = i;
    if (speaker.across > 0 && right_ < 0)
      right_ = i;
  }
}

void
Bands::add(std::span<const float> frames)
{
  resampler_.add(frames);
}

bool
Bands::next(BandPowers &powers)
{
  while (resampler_.take(frame_)) {
    double sum = 0;
    for (std::size_t c = 0; c < channels_.size(); c++) {
      Channel &channel = channels_[c];
      channel.samples[static_cast<std::size_t>(Spectrum::kSize - kHop + filled_)] = frame_[c];
      channel.low.add(frame_[c]);
      sum += static_cast<double>(frame_[c]);
    }
    voicing_.add(sum);
    if (++filled_ < kHop)
      continue;
    filled_ = 0;
    analyze(powers);
    powers.voicing = voicing_.take();
    return true;
  }
  return false;
}

void
Bands::analyze(BandPowers &powers)
{
  powers.sum.fill(0);
  powers.low_peak = powers.low_slope = 0;
  bin_powers_.fill(static_cast<float>(kSilence));
  for (std::size_t c = 0; c < channels_.size(); c++) {
    Channel &channel = channels_[c];
    spectrum_.transform(channel.samples, channel.bins);
    std::copy(channel.samples.begin() + kHop, channel.samples.end(), channel.samples.begin());
    const LowBands::Powers low = channel.low.take(kHop);
    Powers &power = powers.of[c];
    power[0] = low.deep;
    power[1] = low.bass;
    powers.low_peak += low.peak;
    powers.low_slope += low.slope;
    for (std::size_t band = 0; band + 1 < kOctaves.size(); band++) {
      const std::size_t end = std::min(kOctaves[band + 1], bins_);
      float sum = 0;
      for (std::size_t bin = kOctaves[band]; bin < end; bin++) {
        const float bin_power = std::norm(channel.bins[bin]);
        bin_powers_[bin] += bin_power;
        sum += bin_power;
      }
      power[band + kLowBands]
          = kOctaves[band] < end ? static_cast<double>(sum) : power[band + kLowBands - 1];
    }
    for (std::size_t band = 0; band < kBands; band++)
      powers.sum[band] += power[band];
  }
  for (std::size_t band = 0; band + 1 < kOctaves.size(); band++) {
    const std::size_t to = band + kLowBands;
    const std::size_t end = std::min(kOctaves[band + 1], bins_);
    if (kOctaves[band] >= end) {
      powers.uneven[to] = powers.uneven[to - 1];
      continue;
    }
    const auto count = static_cast<double>(end - kOctaves[band]);
    float sum = 0;
    float logarithms = 0;
    for (std::size_t bin = kOctaves[band]; bin < end; bin++) {
      sum += bin_powers_[bin];
      powers.bins[bin] = 10 * std::log10(bin_powers_[bin]);
      logarithms += powers.bins[bin];
    }
    powers.uneven[to] = 10 * std::log10(static_cast<double>(sum) / count)
                        - static_cast<double>(logarithms) / count;
  }
  for (std::size_t bin = std::max(bins_, kOctaves.front() * 2); bin < kOctaves.back(); bin++)
    powers.bins[bin] = powers.bins[bin / 2];
  powers.likeness = 1;
  if (left_ < 0 || right_ < 0)
    return;
  const Spectrum::Bins &left = channels_[static_cast<std::size_t>(left_)].bins;
  const Spectrum::Bins &right = channels_[static_cast<std::size_t>(right_)].bins;
  float both = 0;
  float lefts = 0;
  float rights = 0;
  for (std::size_t bin = kOctaves.front(); bin < kOctaves.back(); bin++) {
    both += left[bin].real() * right[bin].real() + left[bin].imag() * right[bin].imag();
    lefts += std::norm(left[bin]);
    rights += std::norm(right[bin]);
  }
  if (lefts > 0 && rights > 0)
    powers.likeness = static_cast<double>(both / std::sqrt(lefts * rights));
}

double
Bands::delay() const
{
  return resampler_.delay();
}

void
Bands::reset()
{
  resampler_.reset();
  for (Channel &channel : channels_)
    channel = Channel();
  voicing_.reset();
  filled_ = 0;
}

} // namespace sound
