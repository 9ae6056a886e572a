// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/formats/webvtt_cues.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace desk {

using Cue = tactile::WebvttCue;

inline constexpr std::int32_t kLatest = 360'000'000; ///< ms
inline constexpr int kMostPercent = 100;
inline constexpr std::size_t kMostCues = 200'000;

/// Removes cues at an index and inserts others there.
struct Splice
{
  std::size_t at = 0;
  std::size_t remove = 0;
  std::vector<Cue> insert;

  bool operator==(const Splice &) const = default;
};

} // namespace desk
