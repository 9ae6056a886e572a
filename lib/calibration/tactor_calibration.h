// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "calibration/rise_time_fit.h"
#include "calibration/step_response.h"

#include <optional>
#include <vector>

namespace tactor {

/// What the steps of one tactor tell of it. Steps that other steps contradict get their fault here:
/// missed ones, where a motor stood though weaker commands moved it, and outliers among repetitions
/// or far off the fit. None if no rise could be measured. `latency_known`: recording and commands
/// have one clock.
///
/// - start voltage: the least from which, and from all above, the motor left its rest; hold voltage
///   likewise of steps down;
/// - latency: the median first motion of rises from rest to at least half of the strongest command;
/// - rise times: from the latency's end to 90 %.
std::optional<TactorCalibration> calibrate_tactor(std::vector<StepResponse> &responses,
                                                  bool latency_known = true);

/// The rise times that a tactor's calibration was made of, from the latency's end: of all rises
/// without fault. Those from less than the start voltage are from rest, for the motor stood.
std::vector<RiseTimeSample> rise_time_samples(const std::vector<StepResponse> &responses,
                                              const TactorCalibration &tactor);

/// The calibrations of all tactors that a recording's steps tell of, `responses` in any order.
Calibration calibrate(std::vector<StepResponse> &responses, bool latency_known = true);

} // namespace tactor
