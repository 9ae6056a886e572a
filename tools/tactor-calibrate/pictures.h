// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/calibration/calibration.h"
#include "tactor/calibration/step_response.h"

#include <string>
#include <vector>

/// A rise as in the paper's Fig. 4: what was heard, its envelope, the command, the first motion and the 90 %. An SVG document.
std::string envelope_picture(const tactor::StepResponse &response,
                             const tactor::StepEnvelope &envelope);

/// Rise times over start voltage and offset as in the paper's Fig. 5: what was measured as dots, the quadratic as a surface.
std::string surface_picture(const tactor::TactorCalibration &tactor,
                            const std::vector<tactor::StepResponse> &responses);

/// What quadratic and table leave of each measurement, over the target voltage.
std::string residual_picture(const tactor::TactorCalibration &tactor,
                             const std::vector<tactor::StepResponse> &responses);
