// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// Writes a track as a .haptic file, version 1.0.0, of Meta Haptics Studio and Lofelt Studio: an
/// envelope of the strongest cell's level, and one of its frequency where maps have one. Each step
/// lasts one millisecond, since players interpolate. The cell is lost.
std::string write_haptic(const Track &track);

/// Reads a .haptic file as one cell, by the rules of the format's own reader (core/datamodel in
/// github.com/Lofelt/NiceVibrations): amplitudes from 0 to 1, times that do not decrease. An
/// amplitude is a level. An emphasis is its amplitude for 30 ms, as the format's players render it
/// on motors. A frequency is one of tracks/formats/pitch.h. Slopes become steps of 20 ms.
tl::expected<Track, FormatError> read_haptic(std::string_view text);

} // namespace tactile
