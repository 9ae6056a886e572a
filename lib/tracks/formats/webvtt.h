// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// Resolution of WebVTT times (milliseconds) and of levels in text cues (percent).
inline constexpr Time kTextTick = std::chrono::milliseconds(1);
inline constexpr int kTextSteps = 100;

/// Writes a track as WebVTT (W3C Candidate Recommendation, 2019): "NOTE tactile grid=3x3 rate=5",
/// then text cues (write_text_cue()). A cue begins when the map changes and at least every second.
/// Silence is a gap, except for a silent cue at 0 and one at the end that gives the length. Reading
/// it back gives at_resolution(track, kTextTick, kTextSteps).
std::string write_webvtt(const Track &track);

/// Reads WebVTT that an editor may have changed: identifiers, settings, notes, styles and regions
/// are ignored, and so are remarks (is_remark()); gaps are silent. Without the note, the first cue
/// gives the grid. Errors give the line: invalid WebVTT, no map, another grid, cues out of order or
/// overlapping.
tl::expected<Track, FormatError> read_webvtt(std::string_view text);

/// Whether a text is a track, even a faulty one: it has the note of a track, or its first cue is a
/// map. Other texts are subtitles, for example.
bool is_meant_as_track(std::string_view text);

} // namespace tactile
