// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/hashes.h"
#include "listen/onsets.h"
#include "nanoseconds.h"

#include "sound/resampler.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace listen {

using visuotactile::Time;

/// A hash of a film. The strongest hashes of a second have the lowest rank.
struct RankedHash
{
  std::int64_t frame = 0;
  std::uint32_t value = 0;
  unsigned rank = 0; ///< below kRanks
};

inline constexpr unsigned kRanks = 5;
/// Hashes a second up to each rank.
inline constexpr std::array<int, kRanks> kOfRank = { 3, 6, 12, 24, 40 };

inline std::int64_t
second_of(std::int64_t frame)
{
  return static_cast<std::int64_t>(static_cast<double>(frame) / PeakFinder::kFrameRate);
}

/// The part of a film's sound that is kept.
struct FilmSound
{
  std::vector<RankedHash> hashes{};      ///< in order of their frames
  std::vector<std::uint8_t> reference{}; ///< signs() of its onsets
};

/// Resamples sound to kRate.
class Downsampler
{
public:
  /// `rate`: Hz, 1000 to kMostRate.
  explicit Downsampler(int rate);
  static constexpr int kMostRate = 768'000;

  /// Appends to `out`, whose sample n is the sound at n / kRate seconds.
  void add(std::span<const float> mono, std::vector<float> &out);

private:
  sound::Resampler resampler_;
};

/// Computes the FilmSound of a film from its sound, block by block.
class FilmSoundMaker
{
public:
  explicit FilmSoundMaker(int rate);

  void add(std::span<const float> mono);
  FilmSound finish();

private:
  Downsampler downsampler_;
  PeakFinder peaks_finder_;
  Onsets onsets_;
  std::vector<Peak> peaks_;
  FilmSound sound_;
  std::vector<float> samples_;
};

/// Peaks in half a second of a film, and of the heard sound.
inline constexpr int kFilmPeaks = 14;
inline constexpr int kHeardPeaks = 20;

} // namespace listen
