// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// Writes a track as an AHAP file (Apple Haptic and Audio Pattern, version 1.0) for one actuator:
/// a continuous event for each level of the strongest cell, of 30 s at most, which is Core Haptics'
/// limit. Its sharpness is the frequency (tracks/formats/pitch.h), or 0. The cell is lost, as is
/// silence at the end.
std::string write_ahap(const Track &track);

/// Reads an AHAP file as one cell. An event's HapticIntensity is a level, times the pattern's
/// HapticIntensityControl: parameters and curves, whose points are relative to the curve's time.
/// A transient lasts 30 ms. As Core Haptics does, the reader ignores unknown keys, takes defaults
/// for missing ones, and clamps values. HapticSharpness, plus HapticSharpnessControl, is a
/// frequency unless all of them are 0; of events at a time the one that begins last has it.
/// Envelopes of events and audio are ignored. Slopes become steps of 20 ms.
tl::expected<Track, FormatError> read_ahap(std::string_view text,
                                           std::vector<std::string> &ignored);

} // namespace tactile
