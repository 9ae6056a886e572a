// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/low_bands.h"

#include <array>

namespace sound {

/// Measures how periodic a sound is: the normalized autocorrelation between 200 and 1200 Hz, where
/// voices have several partials and the body of an impact few.
class Voicing
{
public:
  static constexpr double kLowestHz = 70; ///< of the pitch
  static constexpr double kHighestHz = 400;

  /// Takes the next sample at kRate.
  void add(double sample);

  /// Voicing of the last 32 ms against those up to 14 ms earlier: the most of any pitch, [0, 1].
  /// About 0 in silence, above 0.8 in vowels.
  double take();

  void reset();

private:
  static constexpr int kStep = 4; ///< samples for one that is kept
  static constexpr int kKeptRate = kRate / kStep;
  static constexpr int kWindow = 128; ///< kept samples
  static constexpr int kLongest = static_cast<int>(kKeptRate / kLowestHz);
  static constexpr int kShortest = static_cast<int>(kKeptRate / kHighestHz);
  static constexpr int kKept = kWindow + kLongest + 1;
  static constexpr int kRoom = 4 * kKept;

  std::array<Biquad, 2> above_{ Biquad(Biquad::Kind::high_pass, 200, 0.5412),
                                Biquad(Biquad::Kind::high_pass, 200, 1.3066) };
  std::array<Biquad, 2> below_{ Biquad(Biquad::Kind::low_pass, 1200, 0.5412),
                                Biquad(Biquad::Kind::low_pass, 1200, 1.3066) };
  std::array<float, kRoom> kept_{}; ///< the newest before end_
  int end_ = kKept;
  int passed_ = 0; ///< since the last that was kept
};

} // namespace sound
