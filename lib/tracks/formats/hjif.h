// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>

namespace tactile {

/// The track as HJIF (MPEG haptics, ISO/IEC 23090-31, version 2023, profile Main): one vibrotactile
/// perception, a channel for each cell with the actuator's place (X = column, Y = rows − 1 − row),
/// the body part Back and an ERM motor as reference device; in it one linear curve from 0 to the
/// track's end, which steps from level to level in a millisecond. Times are cut down to
/// milliseconds, levels are as they are. `date` is in the form of ISO 8601.
std::string write_hjif(const Track &track, const std::string &date);

/// Reads vibrotactile curves: what write_hjif() writes, exactly from 3 ms of length on, and what
/// other tools write within limits. There is one perception; effects are of type Basis, with
/// keyframes, in bands of type Curve or VectorialWave, whose frequency is not felt by an ERM motor
/// and so is left out; of a curve's values the magnitude counts, times the channel's gain. Bands
/// and effects that meet are added up. Curves are taken as linear; where they rise or fall they
/// become steps of 20 ms at their value in the middle. Without places the channels are one row of
/// tactors.
///
/// All that is not so is an error, with the line or the path in the document.
tl::expected<Track, FormatError> read_hjif(std::string_view text);

} // namespace tactile
