// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/motor_model.h"
#include "tactor/planner_settings.h"

namespace tactor {

/// A change of a motor's voltage for a frame.
struct Change
{
  Time effect; ///< running time of the frame
  Time frame;  ///< the frame's duration, > 0
  double volts;
};

/// How long a rise to the voltage begins with a pulse of volts_max. 0: it has none.
Time kick_time(const MotorModel &motor, const Change &change, const PlannerSettings &settings);

/// When the command has to be at the motor: no later than the frame, and no earlier than `previous`
/// and max_lead before the frame. `kick` is that of kick_time().
///
/// Under Compensation::exact this is the latest time from which the motor is at 90 % of the voltage
/// by the frame, from the amplitude that its model has then.
Time arrival_time(const MotorModel &motor, const Change &change, Time previous, Time kick,
                  const PlannerSettings &settings);

} // namespace tactor
