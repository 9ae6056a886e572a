// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/synthesizer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace synth {

namespace {

/// Samples of a channel that are computed at once: its amplitudes stay in the cache.
constexpr std::size_t kBlock = 512;

/// A share of a round, in 2^-64.
std::uint64_t
part_of_round(double rounds)
{
  const double part = rounds - std::floor(rounds);
  return static_cast<std::uint64_t>(std::ldexp(part, 63)) << 1;
}

/// The wave at a phase: 32 bits of it say where in the round.
float
at(const float *samples, std::uint64_t length, std::uint64_t phase)
{
  const std::uint64_t place = (phase >> 32) * length;
  const float *sample = samples + (place >> 32);
  // 24 bits, as many as a float has
  const float share = static_cast<float>(static_cast<std::int32_t>((place >> 8) & 0xffffff))
                      * (1.0F / 16777216.0F);
  return sample[0] + share * (sample[1] - sample[0]);
}

} // namespace

Synthesizer::Synthesizer(int rate, std::vector<Voice> voices, int ramp) : amplitude_(kBlock)
{
  for (Voice &voice : voices) {
    const double advance = voice.wave->frequency / rate;
    const double phase = voice.phase;
    const float gain = voice.gain;
    channels_.push_back({ .voice = std::move(voice),
                          .phase = part_of_round(phase),
                          .advance = part_of_round(advance),
                          .own_advance = advance,
                          .gain = gain });
  }
  for (int i = 0; i < ramp; i++) {
    const double x = (i + 0.5) / ramp;
    ramp_.push_back(
        static_cast<float>(x - std::sin(2 * std::numbers::pi * x) / (2 * std::numbers::pi)));
  }
}

int
Synthesizer::ramp() const
{
  return static_cast<int>(ramp_.size());
}

void
Synthesizer::change(std::size_t index, float amplitude)
{
  Channel &channel = channels_[index];
  channel.level = amplitude > 0 ? std::min(amplitude, 1.0F) : 0.0F; // NaN is 0
  set_amplitude(channel);
  if (channel.wanted > 0 && std::exchange(armed_, false))
    softened_ = 0;
}

void
Synthesizer::set_amplitude(Channel &channel)
{
  channel.wanted = std::min(channel.level * channel.gain, 1.0F);
  begin_ramp(channel);
}

void
Synthesizer::tune(std::size_t index, double frequency)
{
  Channel &channel = channels_[index];
  const Voice &voice = channel.voice;
  if (voice.frequency <= 0 || std::exchange(channel.tuned, frequency) == frequency)
    return;
  const double now = frequency > 0 ? frequency : voice.frequency;
  channel.advance = part_of_round(channel.own_advance * now / voice.frequency);
  channel.gain = voice.gain
                 * static_cast<float>(gain_at(voice.equalizer, now)
                                      / gain_at(voice.equalizer, voice.frequency));
  set_amplitude(channel);
}

void
Synthesizer::begin_ramp(Channel &channel)
{
  const float by = channel.wanted - channel.target;
  const bool joins = channel.under_way > 0 && channel.ramps[channel.under_way - 1].done == 0;
  if (by == 0 || (channel.under_way == kMostRamps && !joins))
    return;
  if (joins)
    channel.ramps[channel.under_way - 1].by += by;
  else
    channel.ramps[channel.under_way++] = { 0, by };
  channel.target = channel.wanted;
}

void
Synthesizer::arm(std::int64_t soft_start)
{
  soft_start_ = softened_ = std::max<std::int64_t>(soft_start, 0);
  armed_ = soft_start_ > 0;
}

bool
Synthesizer::is_silent() const
{
  return std::ranges::all_of(channels_, [](const Channel &channel) {
    return channel.settled == 0 && channel.under_way == 0;
  });
}

/// The channel's next amplitudes, up to the end of a block or of its oldest ramp.
std::span<const float>
Synthesizer::amplitudes(Channel &channel, std::size_t most)
{
  std::size_t count = std::min(most, kBlock);
  if (channel.under_way > 0)
    count = std::min(count, ramp_.size() - static_cast<std::size_t>(channel.ramps[0].done));
  const std::span<float> values = std::span(amplitude_).first(count);
  std::ranges::fill(values, channel.settled);
  for (Ramp &ramp : std::span(channel.ramps).first(channel.under_way)) {
    const float *share = ramp_.data() + ramp.done;
    for (std::size_t i = 0; i < count; i++)
      values[i] += ramp.by * share[i];
    ramp.done += static_cast<int>(count);
  }
  if (channel.under_way > 0 && static_cast<std::size_t>(channel.ramps[0].done) == ramp_.size()) {
    channel.settled += channel.ramps[0].by;
    std::move(channel.ramps.begin() + 1, channel.ramps.begin() + channel.under_way,
              channel.ramps.begin());
    if (--channel.under_way == 0)
      channel.settled = channel.target; // without what rounding has left
    begin_ramp(channel);
  }
  return values;
}

void
Synthesizer::render_channel(Channel &channel, std::size_t index, std::span<float> samples)
{
  const std::size_t step = channels_.size();
  const float *wave = channel.voice.wave->samples.data();
  const std::uint64_t length = channel.voice.wave->samples.size() - 1;
  float *out = samples.data() + index;
  for (std::size_t left = samples.size() / step; left > 0;) {
    const bool silent = channel.settled == 0 && channel.under_way == 0;
    const std::span<const float> amplitude = amplitudes(channel, left);
    std::uint64_t phase = channel.phase;
    for (std::size_t i = 0; i < amplitude.size() && !silent; i++, phase += channel.advance)
      out[i * step] = std::clamp(amplitude[i], 0.0F, 1.0F) * at(wave, length, phase);
    for (std::size_t i = 0; i < amplitude.size() && silent; i++)
      out[i * step] = 0;
    channel.phase += channel.advance * amplitude.size();
    out += amplitude.size() * step;
    left -= amplitude.size();
  }
}

/// The soft start, on all channels at once.
void
Synthesizer::soften(std::span<float> samples)
{
  if (armed_)
    return;
  for (std::size_t i = 0; i < samples.size() && softened_ < soft_start_; softened_++) {
    const float share = static_cast<float>(softened_) / static_cast<float>(soft_start_);
    for (std::size_t channel = 0; channel < channels_.size(); channel++, i++)
      samples[i] *= share;
  }
}

void
Synthesizer::render(std::span<float> samples)
{
  for (std::size_t i = 0; i < channels_.size(); i++)
    render_channel(channels_[i], i, samples);
  soften(samples);
}

void
Synthesizer::skip(std::int64_t count)
{
  for (Channel &channel : channels_)
    channel.phase += channel.advance * static_cast<std::uint64_t>(count);
  if (!armed_)
    softened_ = std::min(softened_ + count, soft_start_);
}

} // namespace synth
