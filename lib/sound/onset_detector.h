// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

#include <array>

namespace sound {

/// Finds blows and explosions in band powers, and tells them from voices and notes.
///
/// A blow fills all bands with noise at once, down to the deepest. A note leaves gaps between its
/// partials; a voice has little below 65 Hz and rises at some frequencies first. So two linear
/// scores of the same features have to be above 0, one against notes, one against voices.
class OnsetDetector
{
public:
  /// Hops after a moment that have to be known.
  static constexpr int kAhead = 2;
  /// No second onset within this time.
  static constexpr int kDeadHops = 16;

  /// Takes the next hop. True if a blow was heard in the hop kAhead before it.
  bool add(const BandPowers &powers);

  /// Powers in the last 45 ms before the hop that add() spoke of, the largest of each band.
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
  };

  /// The hop `ago` before the newest.
  const Hop &hop(int ago) const;
  bool is_blow();

  std::array<Hop, kHeld> hops_{};
  int newest_ = 0;
  int known_ = 0; ///< hops since the reset, up to kHeld
  int dead_ = 0;  ///< hops until the next onset may come
  Powers before_{};
};

} // namespace sound
