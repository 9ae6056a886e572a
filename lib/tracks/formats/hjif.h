// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// Writes a track as HJIF (MPEG haptics, ISO/IEC 23090-31:2023, profile Main). It has one
/// vibrotactile perception, the body part Back, an ERM motor as reference device, and a channel per
/// cell with the actuator's position (X = column, Y = rows − 1 − row). Each channel is one linear
/// curve from 0 to the track's end that steps from level to level within a millisecond. Times are
/// rounded down to milliseconds; levels are exact. With frequencies, in whole Hz, the curves are
/// sine waves. `date`: ISO 8601.
std::string write_hjif(const Track &track, const std::string &date);

/// Reads vibrotactile curves: everything that write_hjif() writes, exactly for tracks of at least 3
/// ms, and other tools' files with these limits. There is one perception. Effects have the type
/// Basis and keyframes, in bands of type Curve or VectorialWave. The frequency of a wave is that of
/// the map, 0 to 1000 Hz; of channels that differ, the last one counts. The magnitude of a curve's
/// values counts, times the channel's gain. Overlapping bands and effects are added. Curves are
/// linear; slopes become steps of 20 ms at their mean value. Channels without positions become one
/// row of tactors.
///
/// Anything else is an error, with the line or the path in the document. Appends to `ignored` what
/// was lost of the frequencies.
tl::expected<Track, FormatError> read_hjif(std::string_view text,
                                           std::vector<std::string> &ignored);

} // namespace tactile
