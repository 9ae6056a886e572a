// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/onset_features.h"

namespace sound {

/// Finds impacts and explosions in band powers, and tells them from voices and notes.
///
/// An impact fills all bands with noise at once, down to the deepest. A note leaves gaps between
/// its partials; a voice has little below 65 Hz and rises at some frequencies first. So linear
/// scores of the same features all have to be above 0 (onset_weights.h).
class OnsetDetector
{
public:
  static constexpr int kAhead = OnsetFeatures::kAhead;
  /// No second onset within this time.
  static constexpr int kDeadHops = 16;

  /// Takes the next hop. True if an impact was heard in the hop kAhead before it.
  bool add(const BandPowers &powers);

  /// Powers in the last 45 ms before the hop that add() spoke of, the largest of each band.
  const Powers &before() const;

  void reset();

private:
  OnsetFeatures features_;
  int dead_ = 0; ///< hops until the next onset may come
};

} // namespace sound
