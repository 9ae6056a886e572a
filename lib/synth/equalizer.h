// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/wave.h"

#include <compare>
#include <memory>
#include <span>

namespace synth {

/// A peak or a dip at `frequency`: the peaking filter of R. Bristow-Johnson's "Cookbook formulae
/// for audio EQ biquad filter coefficients".
struct EqualizerBand
{
  static constexpr double kMostGain = 24; ///< dB
  static constexpr double kLeastQ = 0.1;
  static constexpr double kMostQ = 20;

  double frequency = 60; ///< Hz, 1 to kHighest
  double gain = 0;       ///< dB at `frequency`, -kMostGain to kMostGain
  double q = 1;          ///< kLeastQ to kMostQ

  auto operator<=>(const EqualizerBand &) const = default;
};

/// The factor by which filters in series change a sine of a frequency, in Hz.
double gain_at(std::span<const EqualizerBand> bands, double frequency);

/// A carrier of full scale, and the factor by which it is less or more.
struct Equalized
{
  std::shared_ptr<const Wave> wave; ///< its peak is 1
  double peak = 1;                  ///< 0: silent
};

/// A carrier after filters in series that have settled. The carrier is filtered and not
/// its product with the amplitude, so that a change of amplitude is neither delayed nor rings.
Equalized equalized(const std::shared_ptr<const Wave> &wave, std::span<const EqualizerBand> bands);

} // namespace synth
