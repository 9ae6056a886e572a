// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/rumble_features.h"

#include <array>
#include <span>
#include <vector>

namespace sound {

/// The part of a sound below 65 Hz that is felt as rumble: it resembles engines and thunder rather
/// than the bass of music and a narrator's room, or comes from a channel for low frequency effects,
/// and it stands out from the level of the last seconds. Beside an equally loud voice, it must
/// last.
class Rumble
{
public:
  explicit Rumble(std::span<const Speaker> speakers);

  /// Takes the next hop. Returns its level, [0, 1].
  double add(const BandPowers &powers, double gain_db);

  /// Smoothed powers below 65 Hz, a speaker each.
  std::span<const double> powers() const;

  void reset();

private:
  RumbleFeatures features_;
  std::vector<bool> is_low_; ///< of each speaker: for low frequency effects
  std::array<double, kMaxSpeakers> deep_{};
  double score_ = 0;  ///< smoothed
  double quick_ = 0;  ///< power below 65 Hz, smoothed less
  double middle_ = 0; ///< smoothed power of 65 Hz to 1 kHz: voices, most of music
  double floor_ = 0;  ///< level of the last seconds, dB
  double vowel_ = 0;  ///< power of the loudest vowel, decays
  int lasted_ = 0;    ///< hops
  double fading_ = 0; ///< the weakest since it was like rumble, dB
  bool is_rumble_ = false;
  bool is_felt_ = false;
};

} // namespace sound
