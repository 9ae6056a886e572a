// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "fusion/sound_maps.h"

#include <chrono>
#include <span>
#include <vector>

namespace fusion {

/// Combines maps of picture and sound: one cue for each event. Not thread-safe.
class Fusion
{
public:
  /// An impact so soon after a picture is felt at the place of the picture, which may be over
  /// before its sound begins.
  static constexpr Time kPlaceHolds = std::chrono::milliseconds(250);

  /// The map that is felt in [begin, end). The picture's grid stays. `next` is the next picture, if
  /// it comes soon, and may be null: an impact that sounds a little before is felt at its place.
  tactile::TactileMap mix(Time begin, Time end, const tactile::TactileMap &picture,
                          const tactile::TactileMap &sound, tactile::Mix mix,
                          const tactile::TactileMap *next = nullptr);

  /// Drops the past, after a seek.
  void reset();

private:
  tactile::TactileMap seen_; ///< the last map that was not silent
  Time seen_until_{ 0 };
  bool any_ = false;
};

/// The maps of the sound during a frame shown in [begin, end): few, without gaps, at least one. The
/// next one begins where the sound becomes stronger by a fifth, or after 50 ms. A map has the
/// largest level of each cell, and no cells in silence.
std::vector<SoundMap> pieces(Time begin, Time end, std::span<const SoundMap> sound);

} // namespace fusion
