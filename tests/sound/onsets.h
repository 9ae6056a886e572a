// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/sound_analyzer.h"
#include "sound/synthetic_sound.h"

#include <span>
#include <string>
#include <vector>

/// What was heard in a sound, and how good that is.
namespace judged {

inline constexpr int kRate = 48000;
/// An onset within this time of the truth is right.
inline constexpr double kTolerance = 0.02;

/// All of a synthetic sound, interleaved.
std::vector<float> rendered(const sound::SyntheticSound &made, double seconds, int rate,
                            std::span<const sound::Speaker> speakers);

/// What soundtactile's analysis makes of it.
std::vector<sound::Moment> analyzed(std::span<const float> frames, int rate,
                                    std::span<const sound::Speaker> speakers,
                                    const sound::FeelSettings &settings = {},
                                    bool looks_ahead = false);

/// Seconds of the onsets.
std::vector<double> onsets_of(std::span<const sound::Moment> moments);

/// Seconds of the impacts and explosions.
std::vector<double> impacts_of(const sound::SyntheticSound &made);

/// Each truth and each onset counts once.
struct Count
{
  int right = 0;
  int found = 0;
  int truths = 0;

  void add(std::span<const double> onsets, std::span<const double> truth,
           double tolerance = kTolerance);
  double precision() const;
  double recall() const;
  double f1() const;
};

/// One of aubio's onset detectors.
struct Peer
{
  std::string method;
  double threshold;
};

/// Its methods with thresholds from low to high.
std::vector<Peer> peers();

/// Seconds of the onsets that a peer finds in mono.
std::vector<double> heard_by(const Peer &peer, std::span<const float> mono, int rate,
                             int window = 1024);

} // namespace judged
