// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/envelope.h"
#include "calibration/recording.h"
#include "tactor/command_trace.h"
#include "tactor/time.h"

#include <span>

namespace tactor {

/// Where in the trace's running time a recording without a common clock begins, within a few tens
/// of milliseconds: where what is heard is most like what the motors were told (cross-correlation
/// of envelope and voltage). One channel is enough. What is left is common to all steps and becomes
/// part of their onset.
Time align(const Recording &recording, std::span<const IssuedCommand> trace, Band band);

} // namespace tactor
