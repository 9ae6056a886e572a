// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/text_cue.h"
#include "tracks/track.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tactile {

/// A cue of a track in WebVTT, as a designer edits it.
struct WebvttCue
{
  std::int32_t start = 0;           ///< ms
  std::int32_t end = 0;             ///< ms
  std::vector<std::uint8_t> levels; ///< whole percent, row by row
  std::int32_t frequency = 0;       ///< whole Hz; 0: none
  /// The NOTE blocks in front of it. Lines end with \n; none is empty, but the note may be.
  std::vector<std::string> notes;

  bool operator==(const WebvttCue &) const = default;

  bool has_map_of(const WebvttCue &other) const
  {
    return levels == other.levels && frequency == other.frequency;
  }
};

inline constexpr std::size_t kMostWebvttNotes = 16; ///< a cue; more are lines of the last one
inline constexpr std::size_t kLongestWebvttNote = 4096;

/// Whether a note can stand in a file in front of a cue and be read again as it is.
bool is_webvtt_note(std::string_view note);

/// Levels in percent, frequency in Hz.
void set_map(WebvttCue &cue, const TactileMap &map);
/// A map of as many levels as there are.
TactileMap map_of(const WebvttCue &cue, const Grid &grid);

/// The cues of a track, in whole ms and percent, as near to `before` as can be: boundaries between
/// which nothing changes stay where they are, and a cue with notes stays where it becomes silent.
/// New cues last a second at most. A silent one at the end gives the length where no other does.
std::vector<WebvttCue> cues_of(const Track &track, const std::vector<WebvttCue> &before);

} // namespace tactile
