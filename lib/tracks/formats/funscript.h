// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <string>

namespace tactile {

/// The track for players of one-axis devices: the strongest cell's level in whole percents over
/// time, as the steps that a device which interpolates makes of two actions a millisecond apart.
/// What cell it was is lost, so there is no reader.
std::string write_funscript(const Track &track);

} // namespace tactile
