// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/motor_model.h"

namespace synth {

using visuotactile::Time;

/// An estimate, see docs/elements/tactilesynth.md. A resonator of quality Q that is driven at its
/// resonance f reaches 90 % after ln(10) Q / (π f): 24 ms for Q = 2 and f = 60 Hz.
inline constexpr Time kShakerRise = std::chrono::milliseconds(25);

/// A mass on a spring that a coil moves, such as a bass shaker, exciter or voice coil. Its
/// vibration approaches that of its signal exponentially, up and down, and reaches 90 % after
/// `rise` from rest, at up to `volts_max`. It vibrates at any level.
tactor::MotorParameters shaker(Time rise, double volts_max);

} // namespace synth
