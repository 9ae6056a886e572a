// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactile {

/// Marks a film's tactile tracks, which are subtitles in no language (ISO 639-2: zxx), as ones that
/// no player chooses by itself, for it would draw their numbers:
///
/// - Matroska (RFC 9559): FlagDefault = 0. Where a TrackEntry has none, its size is written in
///   three bytes less, which the flag takes.
/// - MP4 (ISO/IEC 14496-12): track_enabled is taken from the flags of tkhd.
///
/// So no byte outside of these tracks changes or moves. `file` is the whole file. Returns how many
/// tracks are marked so now: none in files of another kind, in such that break off before their
/// tracks, and where a TrackEntry has no room or is not whole.
std::size_t leave_to_choice(std::span<std::uint8_t> file);

} // namespace tactile
