// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace desk {

/// A cue of a track, as a designer edits it.
struct Cue
{
  std::int32_t start = 0;           ///< ms
  std::int32_t end = 0;             ///< ms
  std::vector<std::uint8_t> levels; ///< whole percent, row by row
  /// The NOTE blocks in front of it. Lines end with \n; none is empty, but the note may be.
  std::vector<std::string> notes;

  bool operator==(const Cue &) const = default;
};

inline constexpr std::int32_t kLatest = 360'000'000; ///< ms
inline constexpr int kMostPercent = 100;
inline constexpr std::size_t kMostNotes = 16; ///< a cue
inline constexpr std::size_t kLongestNote = 4096;
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
