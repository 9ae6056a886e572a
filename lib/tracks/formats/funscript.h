// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// Writes a track for players of one-axis devices: the level of the strongest cell in whole percent
/// over time. Each step is two actions one millisecond apart, since devices interpolate. The cell
/// is lost.
std::string write_funscript(const Track &track);

/// The script of another tool with a track in place of the axis that read_funscript() reads.
tl::expected<std::string, FormatError> funscript_with(std::string_view text, const Track &track);

/// Reads a funscript as one cell, whose level is the position, as players drive vibrators with it.
/// In a script with several axes (`axes`, `channels` or `tracks`) the vibration counts (`V0` or
/// `vib`), else the first with actions; the others are ignored, as are `range`, `metadata`, actions
/// before 0:00 and what other tools add, which funscript_with() keeps. Actions may be unordered and
/// their times fractional; positions are clamped to 0 to 100, and turned over where
/// the script is `inverted`. Slopes become steps of 20 ms.
tl::expected<Track, FormatError> read_funscript(std::string_view text,
                                                std::vector<std::string> &ignored);

} // namespace tactile
