// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "sound/low_bands.h"
#include "sound/resampler.h"
#include "sound/speakers.h"
#include "sound/spectrum.h"
#include "sound/voicing.h"

#include <array>
#include <span>
#include <vector>

namespace sound {

/// 18–65 and 65–130 Hz, then octaves from 94 Hz up.
inline constexpr int kBands = 8;
/// Time from one analysis to the next.
inline constexpr int kHop = 80; ///< samples at kRate
inline constexpr Time kHopTime = std::chrono::milliseconds(5);

/// Mean square of each band, around one moment. A band above half the input rate has the power of
/// the band below it.
using Powers = std::array<double, kBands>;

/// dB of single bins of all channels.
using BinLevels = std::array<float, Spectrum::kBins>;

/// First bin of each octave, and the end.
inline constexpr int kLowBands = 2;
inline constexpr std::array<std::size_t, kBands - kLowBands + 1> kOctaves{
  2, 4, 8, 16, 32, 64, 112
};

/// Powers of each channel at one moment.
struct BandPowers
{
  std::array<Powers, kMaxSpeakers> of{};
  Powers sum{};         ///< of all channels
  double low_peak = 0;  ///< the largest square of a sample of 18–130 Hz
  double low_slope = 0; ///< mean square of their differences, of both bands
  /// Unevenness of each octave, dB: the level of the mean power of its bins minus the mean of their
  /// levels: 2.5 of noise, more of tones.
  Powers uneven{};
  BinLevels bins{};
  /// Likeness of the front's left and right above 94 Hz: 1 if they differ in level only, 0 if they
  /// have nothing in common, −1 with opposite phases. 1 without both.
  double likeness = 1;
  double voicing = 0; ///< how periodic the sum of all channels is, [0, 1]: see Voicing
};

/// Computes the powers of the bands every kHopTime from sound of any rate.
class Bands
{
public:
  Bands(int rate, std::span<const Speaker> speakers);

  /// Takes interleaved frames, at most Resampler::kBlock. Then call next() until it is false.
  void add(std::span<const float> frames);

  /// The powers of hop n, which ends at (n + 1) · kHopTime.
  bool next(BandPowers &powers);

  double delay() const;

  void reset();

private:
  struct Channel
  {
    std::array<float, Spectrum::kSize> samples{}; ///< the newest last
    LowBands low;
    Spectrum::Bins bins{};
  };

  void analyze(BandPowers &powers);

  static constexpr double kSilence = 1e-9; ///< power added to each bin: −90 dB

  Resampler resampler_;
  Spectrum spectrum_;
  Voicing voicing_;
  std::vector<Channel> channels_;
  std::vector<float> frame_;
  std::array<float, Spectrum::kBins> bin_powers_{}; ///< of all channels
  std::size_t bins_ = 0;                            ///< below half the input rate
  int left_ = -1;
  int right_ = -1;
  int filled_ = 0; ///< of this hop
};

} // namespace sound
