// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

#include <array>

namespace sound {

inline constexpr int kFeatures = 46;

/// What tells impacts from voices and notes, about one moment: in dB, except those marked.
using Features = std::array<double, kFeatures>;

/// Band powers over time → the features of each moment at which an impact may begin.
class OnsetFeatures
{
public:
  /// Hops after a moment that have to be known.
  static constexpr int kAhead = 2;

  /// Takes the next hop. True if the octaves from 1 kHz became fuller in the hop kAhead before it.
  bool add(const BandPowers &powers);

  /// Of that hop, once add() was true.
  const Features &features() const;

  /// Powers in the last 45 ms before that hop, the largest of each band.
  const Powers &before() const;

  void reset();

private:
  static constexpr int kGap = 2;     ///< hops before a moment that may belong to it
  static constexpr int kPast = 9;    ///< hops before a moment that it is compared with
  static constexpr int kLongGap = 3; ///< the same for its mean
  static constexpr int kLongPast = 20;
  static constexpr int kHeld = kLongPast + kAhead + 1;
  static constexpr double kWholeFloor = -60; ///< dB

  struct Hop
  {
    Powers db{};     ///< of BandPowers::sum
    Powers filled{}; ///< dB
    Powers uneven{}; ///< dB
    Powers power{};
    double voicing = 0;
    double spoken = 0;               ///< how much of the last half second was voiced
    double whole = kWholeFloor;      ///< dB of all bands
    double loudest = kWholeFloor;    ///< the most of that; forgotten by 10 dB a second
    double loud_voice = kWholeFloor; ///< the same of what was voiced
    BinLevels bins{};
  };

  /// The hop `ago` before the newest.
  const Hop &hop(int ago) const;
  void follow_voices(double voicing);
  bool compare();
  Powers risen_bins() const;

  std::array<Hop, kHeld> hops_{};
  int newest_ = 0;
  int known_ = 0; ///< hops since the reset, up to kHeld
  Features features_{};
  Powers before_{};
};

} // namespace sound
