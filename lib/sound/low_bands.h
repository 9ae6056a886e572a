// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/resampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sound {

/// A second-order section (Butterworth's, by the bilinear transform), in transposed direct form II.
class Biquad
{
public:
  enum class Kind
  {
    low_pass,
    high_pass,
  };

  Biquad(Kind kind, double hz, double quality)
  {
    const double turn = 2 * std::numbers::pi * hz / kRate;
    const double alpha = std::sin(turn) / (2 * quality);
    const double cosine = std::cos(turn);
    const double scale = 1 / (1 + alpha);
    const double sign = kind == Kind::low_pass ? 1 : -1;
    b1_ = scale * sign * (1 - sign * cosine);
    b0_ = b1_ * sign / 2;
    a1_ = -2 * cosine * scale;
    a2_ = (1 - alpha) * scale;
  }

  double pass(double sample)
  {
    const double out = b0_ * sample + state1_;
    state1_ = b1_ * sample - a1_ * out + state2_;
    state2_ = b0_ * sample - a2_ * out;
    return out;
  }

  /// Zeroes inaudible rests: denormal numbers are slow.
  void settle()
  {
    if (std::abs(state1_) + std::abs(state2_) < 1e-12)
      state1_ = state2_ = 0;
  }

  void reset()
  {
    state1_ = state2_ = 0;
  }

private:
  double b0_ = 0;
  double b1_ = 0;
  double a1_ = 0;
  double a2_ = 0;
  double state1_ = 0;
  double state2_ = 0;
};

/// The part of one channel that is too low for Spectrum's bins: 18–65 Hz, which voices do not have,
/// and 65–130 Hz.
class LowBands
{
public:
  struct Powers
  {
    double deep = 0;  ///< 18–65 Hz, mean square
    double bass = 0;  ///< 65–130 Hz
    double peak = 0;  ///< the largest square of a sample of both
    double slope = 0; ///< sum of both bands' mean squares of differences of neighboring samples
  };

  void add(double sample)
  {
    const double above = floor_.pass(sample);
    const double deep = deep_[1].pass(deep_[0].pass(above));
    const double bass = bass_[2].pass(bass_[1].pass(bass_[0].pass(above)));
    sums_.deep += deep * deep;
    sums_.bass += bass * bass;
    sums_.peak = std::max(sums_.peak, (deep + bass) * (deep + bass));
    sums_.slope += (deep - last_deep_) * (deep - last_deep_);
    sums_.slope += (bass - last_bass_) * (bass - last_bass_);
    last_deep_ = deep;
    last_bass_ = bass;
  }

  /// The powers since the last call.
  Powers take(int samples)
  {
    const Powers result{ sums_.deep / samples, sums_.bass / samples, sums_.peak,
                         sums_.slope / samples };
    sums_ = {};
    floor_.settle();
    for (Biquad &section : deep_)
      section.settle();
    for (Biquad &section : bass_)
      section.settle();
    return result;
  }

  void reset()
  {
    *this = LowBands();
  }

private:
  static constexpr double kSingle = 0.7071; ///< qualities of Butterworth's filters: one section
  static constexpr double kFirst = 0.5412;  ///< and two
  static constexpr double kSecond = 1.3066;

  Biquad floor_{ Biquad::Kind::high_pass, 18, kSingle };
  std::array<Biquad, 2> deep_{ Biquad(Biquad::Kind::low_pass, 65, kFirst),
                               Biquad(Biquad::Kind::low_pass, 65, kSecond) };
  std::array<Biquad, 3> bass_{ Biquad(Biquad::Kind::high_pass, 65, kSingle),
                               Biquad(Biquad::Kind::low_pass, 130, kFirst),
                               Biquad(Biquad::Kind::low_pass, 130, kSecond) };
  Powers sums_;
  double last_deep_ = 0;
  double last_bass_ = 0;
};

} // namespace sound
