// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// Writes a track for spreadsheets and plots, lossless. The first lines are "# tactile grid=3x3
/// rate=5" and "time_ms,t0,t1,…". Then each change is a line: the time in milliseconds (up to six
/// decimals) and the levels in [0, 1], row-major. The last line is silent and ends the track.
std::string write_csv(const Track &track);

/// Reads that format; errors give the line. Trailing commas, which spreadsheets add, are ignored.
tl::expected<Track, FormatError> read_csv(std::string_view text);

} // namespace tactile
