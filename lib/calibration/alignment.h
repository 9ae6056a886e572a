// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/envelope.h"
#include "calibration/recording.h"
#include "nanoseconds.h"
#include "tactor/command_trace.h"

#include <span>

namespace tactor {

/// Finds the running time at which a recording without a common clock begins, to within a few tens
/// of milliseconds. It is the maximum of the cross-correlation of the first channel's envelope and
/// the commanded voltage. The remaining error is common to all steps and becomes part of their
/// onset.
Time align(const Recording &recording, std::span<const IssuedCommand> trace, Band band);

} // namespace tactor
