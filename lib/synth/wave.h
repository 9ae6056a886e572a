// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <vector>

namespace synth {

/// Skin feels vibration up to this, in Hz; above, an actuator only makes sound.
inline constexpr double kHighest = 1000;

enum class Waveform
{
  sine,
  triangle,
  square,
  noise,  ///< an octave around the frequency
  sample, ///< a loop of one's own
};

/// One round of a carrier, in [-1, 1]. It is read with linear interpolation.
struct Wave
{
  double frequency = 0;       ///< rounds a second
  std::vector<float> samples; ///< of one round, then the first one again

  /// `round` has the samples of one round, at least one; those beyond [-1, 1] are clamped, NaN is
  /// 0.
  Wave(double frequency, std::vector<float> round);
};

/// A waveform, but for `sample`, at a frequency of 1 Hz to kHighest. Its harmonics end at kHighest,
/// and its peak is 1. Noise is the same in each second and each process.
std::shared_ptr<const Wave> make_wave(Waveform waveform, double frequency);

} // namespace synth
