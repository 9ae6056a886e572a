// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"
#include "tracks/format_error.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tactile {

/// A map as a KLV packet (SMPTE ST 336: key, BER length, value), for MPEG transport streams, which
/// have no durations:
///
/// | bytes | what, big-endian |
/// |---|---|
/// | 16 | key: a defined-length pack, node "TACTILE" of the experimental branch (unregistered) |
/// | 1, 3 or more | length of the value, BER |
/// | 1 | version: 1, or 2 with a frequency |
/// | 1, 1 | rows, columns, 1 to 64 |
/// | 8 | duration in nanoseconds |
/// | 4 each | levels in [0, 1], IEEE 754, row-major |
/// | 4 | version 2: frequency in Hz, 1 to 1000, IEEE 754 |
inline constexpr std::array<std::uint8_t, 16> kKlvKey
    = { 0x06, 0x0e, 0x2b, 0x34, 0x02, 0x05, 0x01, 0x01, 0x0f, 'T', 'A', 'C', 'T', 'I', 'L', 'E' };

/// Returns the packet of a map that is shown for `duration` ≥ 0.
std::vector<std::uint8_t> write_klv(const TactileMap &map, Time duration);

/// Reads one packet as a cue that begins at 0. Errors give the byte. They are: another key, a
/// length that does not match the grid, a level that is NaN or outside [0, 1], a duration beyond
/// Track::kMaxEnd, and trailing bytes.
tl::expected<Cue, FormatError> read_klv(std::span<const std::uint8_t> bytes);

} // namespace tactile
