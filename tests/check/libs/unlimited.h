// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"

/// For tests that MotorLimits must not affect.
inline constexpr tactor::MotorLimits kNoLimits{ .max_on_time = tactor::Time(0),
                                                .max_duty = 0,
                                                .max_active = 0 };

inline tactor::PlannerSettings
unlimited(tactor::PlannerSettings settings = {})
{
  settings.limits = kNoLimits;
  return settings;
}
