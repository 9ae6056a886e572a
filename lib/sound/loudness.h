// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"
#include "sound/level.h"

#include <algorithm>
#include <numeric>

namespace sound {

/// The loudness of a film: the level above 375 Hz that it does not exceed for 70 % of the time with
/// sound, followed by 0.3 dB a second at most. One explosion hardly moves it.
class Loudness
{
public:
  /// Takes the next hop. Returns the gain, in dB, that gives the film the usual loudness.
  double add(const BandPowers &powers)
  {
    constexpr double kStep = 0.002; // dB a hop
    constexpr double kPart = 0.7;
    constexpr double kSilenceDb = -50;
    constexpr int kFirst = kLowBands + 2; // the lower octaves contain some of the bass
    const double db = decibels(std::accumulate(powers.sum.begin() + kFirst, powers.sum.end(), 0.0));
    if (db > kSilenceDb)
      db_ += db > db_ ? kStep * kPart : -kStep * (1 - kPart);
    db_ = std::clamp(db_, kUsualDb - kMostDb, kUsualDb + kMostDb);
    return kUsualDb - db_;
  }

  void reset()
  {
    db_ = kUsualDb;
  }

private:
  static constexpr double kUsualDb = -24;
  static constexpr double kMostDb = 10;

  double db_ = kUsualDb;
};

} // namespace sound
