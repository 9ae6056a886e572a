// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>

namespace tactile {

/// Writes a track for players of one-axis devices: the level of the strongest cell in whole percent
/// over time. Each step is two actions one millisecond apart, since devices interpolate. The cell
/// is lost, so there is no reader.
std::string write_funscript(const Track &track);

} // namespace tactile
