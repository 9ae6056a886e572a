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

/// Mean square of each band, about one moment. A band above half the rate that comes in has what
/// the band below it has.
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
  Powers sum{};        ///< of all channels
  double low_peak = 0; ///< the largest square of a sample of 18–130 Hz
  /// The octaves' unevenness, in dB: the mean power of a bin above the mean of the bins' powers in
  /// dB, 2.5 of noise, more of tones.
  Powers uneven{};
  BinLevels bins{};
  /// How alike the front's left and right are, above 94 Hz: 1 if they differ in level only, 0 if
  /// they have nothing in common, −1 with opposite phases. 1 without two of them.
  double likeness = 1;
  double voicing = 0; ///< how periodic the sum of all channels is, [0, 1]: see Voicing
};

/// Sound of any rate → the powers of its bands every kHopTime.
class Bands
{
public:
  Bands(int rate, std::span<const Speaker> speakers);

  /// Takes interleaved frames, at most Resampler::kBlock; then next() until it is false.
  void add(std::span<const float> frames);

  /// The powers of hop n: of what ends at (n + 1) · kHopTime.
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
  std::size_t bins_ = 0;                            ///< below half the rate that comes in
  int left_ = -1;
  int right_ = -1;
  int filled_ = 0; ///< of this hop
};

} // namespace sound
