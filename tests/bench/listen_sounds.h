// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Sounds at 16 kHz to be listened to: films that are mixed of real and synthetic sound, rooms, and
/// what else is heard there. All the same in each run.
namespace listen_bench {

inline constexpr int kSoundRate = 16000;
using Sound = std::vector<float>;

/// Real sounds from a folder of music_*.s16, speech_*.s16 and effect_*.s16: little-endian, mono,
/// 16 kHz.
class Pool
{
public:
  /// `titles`: films of `seconds`, of which no two have the same music or speech at the same speed,
  /// within 2 %. Another `seed` makes others.
  Pool(const std::string &folder, int titles, double seconds, std::uint64_t seed = 0);

  /// A film: scenes of music, speech and effects; each fourth one is synthetic. Those from kOthers
  /// on are of other recordings.
  Sound film(int number, double seconds) const;
  static constexpr int kOthers = 1'000'000;
  /// Other music and other people, which are in no film.
  Sound music(std::uint64_t seed, double seconds) const;
  Sound speech(std::uint64_t seed, double seconds) const;

private:
  /// A stretch of a recording in a film.
  struct Piece
  {
    const Sound *from;
    std::size_t to;    ///< sample of the film
    std::size_t count; ///< samples of the film
    double begin;      ///< sample of the recording
    double speed;
    double level;
  };

  std::vector<Piece> pieces(int number, double seconds) const;

  const std::uint64_t seed_;
  std::vector<Sound> music_;
  std::vector<Sound> other_music_;
  std::vector<Sound> speech_;
  std::vector<Sound> other_speech_;
  std::vector<Sound> effects_;
  std::vector<Sound> other_effects_;
  std::vector<std::vector<Piece>> titles_;
};

Sound pink_noise(std::uint64_t seed, double seconds);

/// What a room makes of it: `decay`: seconds to −60 dB; the direct sound is as loud as the rest.
Sound in_room(const Sound &sound, double decay, std::uint64_t seed);

/// What a telephone passes: 150 to 3400 Hz.
Sound by_telephone(const Sound &sound);

/// Mixes, the first louder by so many dB.
Sound mixed(const Sound &sound, const Sound &other, double ratio);

/// Plays it so many times as fast, by windowed sines.
Sound faster(const Sound &sound, double rate);

} // namespace listen_bench
