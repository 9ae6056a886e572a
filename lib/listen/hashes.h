// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/peaks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace listen {

/// Two peaks: the frequency of the first, and the distances of the second in frequency and time.
struct Hash
{
  std::int64_t frame = 0; ///< of the first peak
  std::uint32_t value = 0;
  float strength = 0; ///< of the weaker peak
};

inline constexpr int kHashBits = 19;

/// Hashes of a film: few, because all are stored. Each peak is combined with the strongest peaks
/// after it.
std::vector<Hash> film_hashes(std::span<const Peak> peaks);

/// Hashes of the heard sound: many, of which some are a film's. Each peak is combined with the
/// peaks after it, also with one of the three numbers rounded the other way. `rate`: film seconds a
/// second. Frames are those of the film.
std::vector<Hash> heard_hashes(std::span<const Peak> peaks, double rate);

} // namespace listen
