// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// Times in WebVTT are whole milliseconds, levels in text cues whole percents.
inline constexpr Time kTextTick = std::chrono::milliseconds(1);
inline constexpr int kTextSteps = 100;

/// The track as WebVTT (W3C Candidate Recommendation, 2019), a text cue (write_text_cue) each,
/// after "NOTE tactile grid=3x3 rate=5". Cues begin where the map changes and at least every
/// second; silence is what lies between them, but for a silent cue at 0 and one at the end that say
/// how long the track is. Reading it gives at_resolution(track, kTextTick, kTextSteps).
std::string write_webvtt(const Track &track);

/// Reads WebVTT that an editor may have changed: identifiers, settings, notes, styles and regions
/// are ignored, a gap is silent. Without the note the first cue's lines give the grid. Errors have
/// their line: what is no WebVTT, no map, of another grid, out of order or overlaps.
tl::expected<Track, FormatError> read_webvtt(std::string_view text);

} // namespace tactile
