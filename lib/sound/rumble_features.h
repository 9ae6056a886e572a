// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

#include <array>
#include <span>

namespace sound {

/// Computes features from band powers, which separate engines, thunder and explosions from the bass
/// of music and from voices.
class RumbleFeatures
{
public:
  /// The first is the level below 65 Hz, in dB: it decides whether there is anything.
  enum Index
  {
    deep,
    over,                      ///< dB more below 65 Hz than in each higher band
    crest = over + kBands - 1, ///< peak over mean power of 18–130 Hz in 0.4 s, dB: music beats
    voicing,                   ///< of 0.1 s, 10 if it is full
    uneven,                    ///< dB: of tones
    long_voicing,              ///< of 1 s
    long_uneven,
    busy,         ///< mean change of the octaves' levels in 20 ms, of 2 s
    varying,      ///< 10 times the relative variation of the amplitude below 65 Hz in 0.4 s
    over_seconds, ///< dB more below 65 Hz than in the last 2 s
    count,
  };

  /// Takes the next hop. Returns the features up to it, valid until the next call.
  std::span<const float, count> add(const BandPowers &powers);

  void reset()
  {
    *this = RumbleFeatures();
  }

private:
  static constexpr std::size_t kPart = 4;   ///< hops
  static constexpr std::size_t kParts = 20; ///< 0.4 s

  /// The sums over kPart hops.
  struct Part
  {
    double deep = 0;
    double low = 0; ///< 18–130 Hz
    double peak = 0;
  };

  void follow_parts(const BandPowers &powers);

  Powers smooth_{};
  double voicing_ = 0;
  double uneven_ = 0;
  double long_voicing_ = 0;
  double long_uneven_ = 0;
  double busy_ = 0;
  std::array<std::array<float, kBands>, 4> levels_{}; ///< of the last hops, dB
  double seconds_ = -70;                              ///< dB
  std::array<Part, kParts> parts_{};
  Part part_;
  std::size_t hops_ = 0;
  double crest_ = 0;
  double varying_ = 0;
  std::array<float, count> features_{};
};

} // namespace sound
