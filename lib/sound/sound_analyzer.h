// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"
#include "sound/loudness.h"
#include "sound/onset_detector.h"
#include "sound/pitch.h"
#include "sound/place.h"
#include "sound/rumble.h"

#include <array>
#include <span>
#include <vector>

namespace sound {

struct FeelSettings
{
  double gain_db = 0;  ///< added to every sound before its level
  bool impacts = true; ///< impacts, explosions and shots are felt
  bool rumble = true;  ///< rumble below 65 Hz is felt
  float surer = 0;     ///< more than the least score that an impact needs
};

/// The effects during kHopTime.
struct Moment
{
  Time begin{ 0 };     ///< of the sound since the reset
  float level = 0;     ///< [0, 1]
  float frequency = 0; ///< Hz, where the level is not 0
  Place place;
  bool onset = false; ///< an impact or an explosion begins within 8 ms of the middle
};

/// Computes the felt level and place of a film's sound over time. The result depends on the frames
/// only, not on their blocks. After the first blocks it allocates nothing. Not thread-safe.
class SoundAnalyzer
{
public:
  static constexpr int kLowestRate = 8000; ///< Hz
  static constexpr int kHighestRate = 192000;

  /// `rate` in [kLowestRate, kHighestRate], 1 to kMaxSpeakers speakers.
  /// `looks_ahead`: impacts are known 80 ms later, and better.
  SoundAnalyzer(int rate, std::span<const Speaker> speakers, bool looks_ahead = false);

  /// Takes interleaved frames, any number. Returns the moments that are known now, valid until the
  /// next call.
  std::span<const Moment> add(std::span<const float> frames, const FeelSettings &settings);

  /// Time after the end of a moment until which its analysis needs sound.
  Time delay() const;

  bool has_rear() const;

  /// Drops the past, for a seek. The next frame is at time 0.
  void reset();

private:
  static constexpr int kHeld = OnsetFeatures::kLater + OnsetFeatures::kPast + 1; ///< hops

  /// An impact while it lasts.
  struct Impact
  {
    bool lasts = false;
    int hops = 0;      ///< since its onset
    Powers before{};   ///< powers just before it
    double smooth = 0; ///< power above `before`, smoothed
    double power = 0;  ///< the least of `smooth` since the onset
    double loudest = 0;
    double level = 0;
    Powers excess{}; ///< of the last hop, above `before`
    float frequency = 0;
    Place place;
  };

  const BandPowers &powers(int ago) const;
  Moment analyze(bool onset, const FeelSettings &settings);
  void begin_impact();
  double feel_impact(double gain_db);

  std::vector<Speaker> speakers_;
  bool has_rear_;
  Time delay_;
  Bands bands_;
  OnsetDetector detector_;
  std::array<BandPowers, kHeld> held_{};
  int newest_ = 0;
  std::int64_t hop_ = 0; ///< the next
  Impact impact_;
  Rumble rumble_;
  Pitch impact_pitch_;
  Pitch rumble_pitch_;
  Loudness loudness_;
  std::vector<Moment> moments_;
};

} // namespace sound
