// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

#include <array>

namespace sound {

inline constexpr int kFeatures = 41;

/// What tells blows from voices and notes, about one moment: in dB, except those marked.
using Features = std::array<double, kFeatures>;

/// Band powers over time → the features of each moment at which a blow may begin.
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

  struct Hop
  {
    Powers db{};     ///< of BandPowers::sum
    Powers filled{}; ///< dB
    Powers uneven{}; ///< dB
    Powers power{};
    BinLevels bins{};
  };

  /// The hop `ago` before the newest.
  const Hop &hop(int ago) const;
  bool compare();
  Powers risen_bins() const;

  std::array<Hop, kHeld> hops_{};
  int newest_ = 0;
  int known_ = 0; ///< hops since the reset, up to kHeld
  Features features_{};
  Powers before_{};
};

} // namespace sound
