// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/peaks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace listen {

/// Two peaks: the frequency of the first, and how far in frequency and time the second is.
struct Hash
{
  std::int64_t frame = 0; ///< of the first peak
  std::uint32_t value = 0;
  float strength = 0; ///< of the weaker peak
};

inline constexpr int kHashBits = 19;

/// Few hashes of a film, as they are many: of each peak with the strongest that follow it.
std::vector<Hash> film_hashes(std::span<const Peak> peaks);

/// Many hashes of what is heard, of which some are a film's: of each peak with each that follows
/// it, and likewise if it were a little off. `rate`: of the film that would play, to its own; the
/// frames are the film's.
std::vector<Hash> heard_hashes(std::span<const Peak> peaks, double rate);

} // namespace listen
