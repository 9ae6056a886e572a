// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/calibration.h"
#include "calibration/step_response.h"

#include <cairo.h>

#include <vector>

// Size of all pictures.
inline constexpr double kPictureWidth = 640;
inline constexpr double kPictureHeight = 360;

/// A rise as in the paper's Fig. 4: the recording and its envelope, with command, first motion and
/// 90 %.
void draw_envelope(cairo_t *cairo, const tactor::StepResponse &response,
                   const tactor::StepEnvelope &envelope);

/// Rise times over start voltage and offset as in the paper's Fig. 5: measurements as dots, the
/// quadratic as a surface.
void draw_surface(cairo_t *cairo, const tactor::TactorCalibration &tactor,
                  const std::vector<tactor::StepResponse> &responses);

/// Residuals of quadratic and table over the target voltage.
void draw_residuals(cairo_t *cairo, const tactor::TactorCalibration &tactor,
                    const std::vector<tactor::StepResponse> &responses);
