// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// Reads a .tact file of bHaptics Designer as 5 × 4 cells: the vest's front and back, added, by the
/// motors' order, row by row from the top left. Patterns of other devices are ignored, and refused
/// if there is none of a vest. As the maker's published clients have the format
/// (github.com/bhaptics/haptic-library, tact-python), with files of bhaptics/haptic-guide:
///
/// - An effect begins at its startTime; its feedbacks last from startTime to endTime (dots) or from
/// point to point (paths), within its offsetTime. Times are milliseconds. - A dot is a motor with
/// an intensity from 0 to 1. - A path moves from point to point, and is sampled every 20 ms, the
/// format's interval. The four motors around it share its intensity, linear in the distance. -
/// playbackType FADE_IN, FADE_OUT and FADE_IN_OUT are linear slopes, which become steps of 20 ms. -
/// A layer (track) that is not enabled is silent.
tl::expected<Track, FormatError> read_tact(std::string_view text,
                                           std::vector<std::string> &ignored);

} // namespace tactile
