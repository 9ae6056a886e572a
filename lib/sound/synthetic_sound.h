// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "sound/speakers.h"

#include <cstdint>
#include <span>
#include <vector>

namespace sound {

enum class SoundKind
{
  impact,    ///< an impact: within 2 ms, over after 0.1–0.5 s
  explosion, ///< within 4 ms, with a low roll of 1–3 s
  rumble,    ///< swells within 0.3–0.6 s: an engine, an earthquake
  music,     ///< a note or a hi-hat
};

/// One sound of the ground truth. Its loudest moment is within 10 ms of `begin`, but for rumble.
struct SoundEvent
{
  SoundKind kind = SoundKind::impact;
  Time begin{ 0 };
  Time end{ 0 };     ///< when it has fallen by 20 dB
  double across = 0; ///< −1: left, 1: right
  double behind = 0; ///< 0: in front, 1: behind; without speakers there, in front
};

struct SoundSettings
{
  std::uint64_t seed = 0;
  double seconds = 60; ///< length of the sound, [0, 3600]; silence follows
  bool impacts = true; ///< one every 0.8–2 s
  bool explosions = false;
  bool rumble = false;
  bool music = false;
  double music_db = -20;   ///< root mean square, in dB of full scale
  double impacts_db = -20; ///< root mean square of an impact's first 100 ms
  bool panned = true;      ///< sounds are at places of their own, else in the middle of the front
};

/// Sounds over time, with their ground truth. A pure function of settings, rate and frame number:
/// the same in any blocks and after a seek. All sounds consist of sines below 7.5 kHz (hi-hats: 15
/// kHz), without those above half the rate: they are the same at any rate.
class SyntheticSound
{
public:
  explicit SyntheticSound(const SoundSettings &settings);

  /// The events to be felt and, after them, notes. By time within each kind.
  const std::vector<SoundEvent> &events() const;

  /// Writes frames from `first` on, interleaved. `rate` in Hz; size of `out`: a multiple of the
  /// speakers' number.
  void render(int rate, std::int64_t first, std::span<const Speaker> speakers,
              std::span<float> out) const;

private:
  struct Partial
  {
    double hz;
    double amplitude;
    double phase; ///< at the begin, radians
  };
  /// Partials that swell and fade together: (1 − exp(−t/attack)) · exp(−t/decay).
  struct Voice
  {
    std::size_t event;
    double attack;
    double decay;
    std::vector<Partial> partials;
  };

  void add_impact(double at, double db, double across, double behind, std::uint64_t seed);
  void add_explosion(double at, double across, double behind, std::uint64_t seed);
  void add_rumble(double at, std::uint64_t seed);
  void add_music(std::uint64_t seed);
  void add_note(double at, double hz, double level, double across, std::uint64_t seed);
  void add_hat(double at, double level, std::uint64_t seed);
  std::size_t add_event(SoundKind kind, double at, double seconds, double across, double behind);
  void render_block(int rate, std::int64_t first, const Voice &voice, double *out) const;

  SoundSettings settings_;
  std::vector<SoundEvent> events_;
  std::vector<Voice> voices_;
};

/// The share of a sound's amplitude in each speaker, by constant power. A place between the front
/// and what is behind, or left and right, is shared by both.
void pan(double across, double behind, std::span<const Speaker> speakers, std::span<double> gains);

} // namespace sound
