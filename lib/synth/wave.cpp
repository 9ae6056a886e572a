// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/wave.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <random>
#include <utility>

namespace synth {

namespace {

/// Interpolated linearly, a harmonic h is off by (2πh / length)² / 8: of a sine by -130 dB.
constexpr std::size_t kSineLength = 4096;
constexpr std::size_t kHarmonicsLength = 16384;
constexpr std::size_t kNoiseLength = 65536;

/// Adds a partial of `rounds` periods: amplitude · sin(phase + 2π · rounds · i / length).
void
add_partial(std::vector<double> &sum, int rounds, double amplitude, double phase)
{
  const std::complex<double> turn
      = std::polar(1.0, 2 * std::numbers::pi * rounds / static_cast<double>(sum.size()));
  std::complex<double> point = amplitude * std::polar(1.0, phase); // amplitudes may be negative
  for (double &value : sum) {
    value += point.imag();
    point *= turn;
  }
}

std::vector<double>
harmonics(Waveform waveform, double frequency)
{
  if (waveform == Waveform::sine) {
    std::vector<double> sum(kSineLength, 0.0);
    add_partial(sum, 1, 1, 0);
    return sum;
  }
  std::vector<double> sum(kHarmonicsLength, 0.0);
  for (int h = 1; h * frequency <= kHighest; h += 2) {
    const double sign = waveform == Waveform::triangle && h % 4 == 3 ? -1 : 1;
    add_partial(sum, h, sign / (waveform == Waveform::triangle ? h * h : h), 0);
  }
  return sum;
}

/// Partials of equal strength a hertz apart.
std::vector<double>
noise(double frequency)
{
  std::vector<double> sum(kNoiseLength, 0.0);
  std::mt19937 random; // NOLINT(cert-msc32-c,cert-msc51-cpp): the same in each process
  const int first = std::max(static_cast<int>(std::lround(frequency / std::numbers::sqrt2)), 1);
  const int last = static_cast<int>(std::min(frequency * std::numbers::sqrt2, kHighest));
  for (int rounds = first; rounds <= std::max(first, last); rounds++)
    add_partial(sum, rounds, 1, 2 * std::numbers::pi * random() / 4294967296.0);
  return sum;
}

} // namespace

Wave::Wave(double frequency, std::vector<float> round)
    : frequency(frequency), samples(std::move(round))
{
  for (float &sample : samples)
    sample = std::isnan(sample) ? 0 : std::clamp(sample, -1.0F, 1.0F);
  samples.push_back(samples.front());
}

std::shared_ptr<const Wave>
make_wave(Waveform waveform, double frequency)
{
  const bool is_noise = waveform == Waveform::noise;
  const std::vector<double> sum = is_noise ? noise(frequency) : harmonics(waveform, frequency);
  double peak = 0;
  for (const double value : sum)
    peak = std::max(peak, std::abs(value));
  std::vector<float> round;
  round.reserve(sum.size() + 1);
  for (const double value : sum)
    round.push_back(static_cast<float>(value / peak));
  return std::make_shared<const Wave>(is_noise ? 1 : frequency, std::move(round));
}

} // namespace synth
