// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tactor {

/// Takes mains hum out of a signal: a fundamental near 50 or 60 Hz (mains keep within 0.3 Hz) and
/// its harmonics below `highest_hz`, fitted where the motor rests and subtracted everywhere.
/// `rests` tells of each sample whether the motor rests. Returns the hum's RMS; 0, and leaves the
/// signal alone, where there is no hum worth the name.
double remove_mains_hum(std::vector<double> &signal, const std::vector<bool> &rests, double rate,
                        double highest_hz);

} // namespace tactor
