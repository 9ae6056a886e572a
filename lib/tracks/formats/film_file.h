// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactile {

/// Marks a film's tactile tracks as disabled by default, so that no player selects them and draws
/// their numbers. They are subtitle tracks of language zxx (ISO 639-2: no linguistic content).
///
/// - Matroska (RFC 9559): sets FlagDefault = 0. If a TrackEntry has no FlagDefault, its size field
///   is shortened by three bytes to make room for it.
/// - MP4 (ISO/IEC 14496-12): clears track_enabled in the flags of tkhd.
///
/// No byte outside of these tracks changes or moves. `file` is the whole file. Returns the number
/// of tracks marked: 0 for other kinds of files and for files truncated before their tracks. A
/// TrackEntry that has no room or is malformed is skipped.
std::size_t disable_by_default(std::span<std::uint8_t> file);

} // namespace tactile
