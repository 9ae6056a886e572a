// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "people/detector.h"

namespace people {

/// OpenCV's cascade for frontal faces. It is a module that is loaded when the detector is made, as
/// it needs large libraries.
///
/// The module is searched in $VISUOTACTILE_MODULES, the cascade in $VISUOTACTILE_CASCADES, by
/// default where they are installed.
MakeDetector cascade_detector();

} // namespace people
