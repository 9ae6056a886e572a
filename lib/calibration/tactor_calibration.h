// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "calibration/rise_time_fit.h"
#include "calibration/step_response.h"

#include <optional>
#include <vector>

namespace tactor {

/// Calibration of one tactor from its steps. Steps contradicted by others get their fault here:
/// `missed` if the motor stood still though weaker commands moved it, and `outlier` if far from
/// repetitions or from the fit. None if no rise could be measured. `latency_known`: recording and
/// commands share a clock.
///
/// - start voltage: the lowest at which, and above which, the motor left its rest; the hold voltage
///   likewise from steps down;
/// - latency: the median onset of rises from rest to at least half of the highest voltage;
/// - rise times: from the end of the latency to 90 %.
std::optional<TactorCalibration> calibrate_tactor(std::vector<StepResponse> &responses,
                                                  bool latency_known = true);

/// The rise times behind a tactor's calibration, from the end of the latency: all rises without
/// fault. Rises from below the start voltage count as from rest, where the motor stood still.
std::vector<RiseTimeSample> rise_time_samples(const std::vector<StepResponse> &responses,
                                              const TactorCalibration &tactor);

/// Calibrations of all tactors with steps in `responses`, in any order.
Calibration calibrate(std::vector<StepResponse> &responses, bool latency_known = true);

} // namespace tactor
