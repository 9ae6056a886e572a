// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tactor {

/// Removes mains hum from a signal: a fundamental near 50 or 60 Hz (mains frequencies vary by 0.3
/// Hz at most) and its harmonics below `highest_hz`. The hum is fitted to the samples in which the
/// motor rests, given by `rests`, and subtracted everywhere. Returns the hum's RMS, or 0 if there
/// is no significant hum; the signal is then unchanged.
double remove_mains_hum(std::vector<double> &signal, const std::vector<bool> &rests, double rate,
                        double highest_hz);

} // namespace tactor
