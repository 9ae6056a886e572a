// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"
#include "tactor/command_trace.h"
#include "tactor/driver.h"
#include "tactorsettings.h"

#include <gst/gst.h>
#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <vector>

/// What tactorsink opens for a play: board, trace and calibration.
struct TactorOpening
{
  std::unique_ptr<tactor::Driver> driver;      ///< open
  std::unique_ptr<tactor::CommandTrace> trace; ///< NULL: none is wanted
  tactor::PlannerSettings planner;             ///< with what was agreed on with the board
  std::vector<tactor::MotorParameters> motors; ///< as measured; empty: no calibration
  tactor::Time latency{ 0 };                   ///< the longest on the way to a motor
};

/// Opens them. `notify` is told of the board on any thread of the driver's, from before this returns. Warns on the element's bus where
/// motors are slower than max-lead.
[[nodiscard]] tl::expected<TactorOpening, tactor::DriverError>
open_tactors(GstElement *element, const TactorSettings &settings,
             std::function<void(const tactor::DriverEvent &)> notify);
