// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactile {

/// Marks the tactile tracks of an MP4 file (ISO/IEC 14496-12) as not enabled, so that no player
/// selects them and draws their numbers: ffmpeg enables the first subtitles. They are subtitle
/// tracks of language zxx (ISO 639-2: no linguistic content).
///
/// No other bit changes. `file` is the whole file. Returns the number of tracks marked: 0 for other
/// kinds of files and for files truncated before their tracks.
std::size_t disable_by_default(std::span<std::uint8_t> file);

} // namespace tactile
