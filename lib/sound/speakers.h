// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

/// From the sound of a film to its vibration: level, time and place.
namespace sound {

inline constexpr int kMaxSpeakers = 8; ///< 7.1

/// The place of a channel's loudspeaker, as seen by the audience.
struct Speaker
{
  enum class Role
  {
    place,  ///< shows the place of a sound
    center, ///< carries voices: analyzed, but shows no place
    low,    ///< low frequency effects, which are everywhere
  };
  Role role = Role::center;
  double across = 0; ///< −1: left, 1: right
  double behind = 0; ///< 0: in front, 1: behind

  bool operator==(const Speaker &) const = default;
};

inline constexpr Speaker kCenter{ Speaker::Role::center, 0, 0 };
inline constexpr Speaker kLow{ Speaker::Role::low, 0, 0 };

/// A loudspeaker with a place.
constexpr Speaker
speaker_at(double across, double behind)
{
  return { Speaker::Role::place, across, behind };
}

/// Mono, stereo, 5.1 and 7.1 in the order of WAV files; else `channels` of unknown place.
inline std::vector<Speaker>
usual_speakers(int channels)
{
  const Speaker left = speaker_at(-1, 0);
  const Speaker right = speaker_at(1, 0);
  const Speaker rear_left = speaker_at(-1, 1);
  const Speaker rear_right = speaker_at(1, 1);
  switch (channels) {
  case 2:
    return { left, right };
  case 6:
    return { left, right, kCenter, kLow, rear_left, rear_right };
  case 8:
    return {
      left, right, kCenter, kLow, rear_left, rear_right, speaker_at(-1, 1), speaker_at(1, 1)
    };
  default:
    return std::vector<Speaker>(static_cast<std::size_t>(channels), kCenter);
  }
}

} // namespace sound
