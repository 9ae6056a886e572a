// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// The track as MPEG-V sensory effect metadata (ISO/IEC 23005-3): a vibration of TactileType on the
/// back for each map that is felt, as an ArrayIntensity of as many equal rows as there are samples
/// in its time, at the track's rate (5 Hz if it has none). A silent effect at the end says how long
/// the track is; a comment has the grid. Times are cut down to milliseconds.
std::string write_sem(const Track &track);

/// Reads effects of TactileType with ArrayIntensity, or of VibrationType as one cell, that do not
/// overlap. Times are whole units of the document's timeScale, which it has to say; effects that
/// fade are refused. Without our comment as many tactors as are a square number are taken as a
/// square, others as one row. Errors have their line. Documents with a DTD are refused, nothing is
/// loaded from elsewhere.
tl::expected<Track, FormatError> read_sem(std::string_view text);

} // namespace tactile
