// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// The track for spreadsheets and plots, without loss: "# tactile grid=3x3 rate=5", then
/// "time_ms,t0,t1,…", then a line for each change with the time in milliseconds (up to six
/// decimals) and the levels in [0, 1], row by row, which hold until the next line. The last line
/// ends the track and is silent.
std::string write_csv(const Track &track);

/// Reads that; errors have their line. Lines that a spreadsheet has filled up with commas are fine.
tl::expected<Track, FormatError> read_csv(std::string_view text);

} // namespace tactile
