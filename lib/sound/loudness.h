// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"
#include "sound/level.h"

#include <algorithm>
#include <numeric>

namespace sound {

/// The loudness of a film: the level above 375 Hz that it does not exceed for 70 % of the time with
/// sound. It is followed by 1.4 dB a second at most in the first 20 s, then ever more slowly, down
/// to 0.28. One explosion hardly moves it.
class Loudness
{
public:
  /// Takes the next hop. Returns the gain, in dB, that gives the film the usual loudness.
  double add(const BandPowers &powers)
  {
    constexpr double kFirst = 0.01; // dB a hop
    constexpr double kLater = 0.002;
    constexpr double kFirstHops = 4000;
    constexpr double kPart = 0.7;
    constexpr double kSilenceDb = -50;
    constexpr double kSilenceOfWeakDb = -26; // against the loudness
    constexpr int kBand = kLowBands + 2;     // the lower octaves contain some of the bass
    const double db = decibels(std::accumulate(powers.sum.begin() + kBand, powers.sum.end(), 0.0));
    if (db < std::min(kSilenceDb, db_ + kSilenceOfWeakDb))
      return kUsualDb - db_;
    const double step = std::clamp(kFirst * kFirstHops / ++hops_, kLater, kFirst);
    db_ += db > db_ ? step * kPart : -step * (1 - kPart);
    db_ = std::clamp(db_, kUsualDb - kMostDb, kUsualDb + kMostDb);
    return kUsualDb - db_;
  }

  void reset()
  {
    *this = Loudness();
  }

private:
  static constexpr double kUsualDb = -24;
  static constexpr double kMostDb = 16;

  double db_ = kUsualDb;
  double hops_ = 0; ///< with sound
};

} // namespace sound
