// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"

#include <vector>

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

/// The commands of a new planner for its first map.
inline std::vector<tactor::Command>
first_plan(const tactor::PlannerSettings &settings, int tactors, const std::vector<float> &levels)
{
  tactor::CommandPlanner planner(tactors, unlimited(settings));
  return planner.plan(tactor::Time(0), std::chrono::milliseconds(33), levels);
}
