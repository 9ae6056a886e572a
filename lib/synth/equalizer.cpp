// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/equalizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace synth {

namespace {

/// Samples a second that a filter needs at least: its poles are far below half of it.
constexpr double kLeastRate = 16 * kHighest;

/// A second-order filter in its transposed direct form II.
class Biquad
{
public:
  Biquad(const EqualizerBand &band, double rate)
  {
    const double a = std::pow(10, band.gain / 40);
    const double angle = 2 * std::numbers::pi * band.frequency / rate;
    const double alpha = std::sin(angle) / (2 * band.q);
    const double a0 = 1 + alpha / a;
    b_ = { (1 + alpha * a) / a0, -2 * std::cos(angle) / a0, (1 - alpha * a) / a0 };
    a_ = { -2 * std::cos(angle) / a0, (1 - alpha / a) / a0 };
  }

  /// Filters a round of what repeats without end.
  void filter(std::vector<double> &round)
  {
    std::vector<double> first = round;
    state_ = {};
    run(first);
    state_ = repeated(first.size());
    run(round);
  }

private:
  using State = std::array<double, 2>;
  using Matrix = std::array<State, 2>;

  static Matrix product(const Matrix &left, const Matrix &right)
  {
    Matrix result{};
    for (std::size_t i = 0; i < 2; i++)
      for (std::size_t j = 0; j < 2; j++)
        result[i][j] = left[i][0] * right[0][j] + left[i][1] * right[1][j];
    return result;
  }

  void run(std::vector<double> &samples)
  {
    for (double &sample : samples) {
      const double out = b_[0] * sample + state_[0];
      state_[0] = b_[1] * sample - a_[0] * out + state_[1];
      state_[1] = b_[2] * sample - a_[1] * out;
      sample = out;
    }
  }

  /// The state s in which each round begins and ends, by that in which one ends that began at rest:
  /// s = Mⁿ s + state_, where M is what a sample of zero makes of a state.
  State repeated(std::size_t samples) const
  {
    Matrix m{ { { 1, 0 }, { 0, 1 } } };
    Matrix square{ { { -a_[0], 1 }, { -a_[1], 0 } } };
    for (std::size_t n = samples; n > 0; n /= 2, square = product(square, square))
      if (n % 2 == 1)
        m = product(m, square);
    const double p = 1 - m[0][0];
    const double q = 1 - m[1][1];
    const double determinant = p * q - m[0][1] * m[1][0]; // poles lie within the unit circle
    return { (q * state_[0] + m[0][1] * state_[1]) / determinant,
             (m[1][0] * state_[0] + p * state_[1]) / determinant };
  }

  std::array<double, 3> b_;
  std::array<double, 2> a_; ///< without the first, 1
  State state_{};
};

/// A round as it is read, with `times` as many samples.
std::vector<double>
interpolated(const Wave &wave, std::size_t times)
{
  std::vector<double> round;
  round.reserve((wave.samples.size() - 1) * times);
  for (std::size_t i = 0; i + 1 < wave.samples.size(); i++)
    for (std::size_t part = 0; part < times; part++)
      round.push_back(std::lerp(static_cast<double>(wave.samples[i]),
                                static_cast<double>(wave.samples[i + 1]),
                                static_cast<double>(part) / static_cast<double>(times)));
  return round;
}

} // namespace

/// That of the analog prototypes: at kLeastRate and more, the filters differ from them by less than
/// can be felt.
double
gain_at(std::span<const EqualizerBand> bands, double frequency)
{
  std::complex<double> gain = 1;
  for (const EqualizerBand &band : bands) {
    const double a = std::pow(10, band.gain / 40);
    const std::complex<double> s(0, frequency / band.frequency);
    gain *= (s * s + s * a / band.q + 1.0) / (s * s + s / (a * band.q) + 1.0);
  }
  return std::abs(gain);
}

Equalized
equalized(const std::shared_ptr<const Wave> &wave, std::span<const EqualizerBand> bands)
{
  const double own_rate = wave->frequency * static_cast<double>(wave->samples.size() - 1);
  const double times = bands.empty() ? 1 : std::max(1.0, std::ceil(kLeastRate / own_rate));
  std::vector<double> round = interpolated(*wave, static_cast<std::size_t>(times));
  for (const EqualizerBand &band : bands)
    Biquad(band, own_rate * times).filter(round);
  double peak = 0;
  for (const double sample : round)
    peak = std::max(peak, std::abs(sample));
  if (peak == 0 || (peak == 1 && bands.empty()))
    return { wave, peak };
  std::vector<float> samples;
  samples.reserve(round.size() + 1);
  for (const double sample : round)
    samples.push_back(static_cast<float>(sample / peak));
  return { std::make_shared<const Wave>(wave->frequency, std::move(samples)), peak };
}

} // namespace synth
