// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// Writes a track as MPEG-V sensory effect metadata (ISO/IEC 23005-3). Each map that is not silent
/// becomes a vibration of TactileType on the back. Its ArrayIntensity has one row per sample at the
/// track's rate (5 Hz if it has none), all rows equal; fewer where a map's would exceed 8 MiB, or
/// the track's 128 MiB. A silent effect at the end gives the track's length; a comment gives the
/// grid. Times are rounded down to milliseconds.
std::string write_sem(const Track &track);

/// Reads effects of TactileType with ArrayIntensity, or of VibrationType as one cell, that do not
/// overlap. Times are integers in units of the document's timeScale, which is required. Effects
/// that fade are rejected. Without our comment, tactors form a square if their number is a square
/// number, else one row. Errors give the line. Documents with a DTD are rejected; nothing external
/// is loaded.
tl::expected<Track, FormatError> read_sem(std::string_view text);

} // namespace tactile
