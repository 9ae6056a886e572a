// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"
#include "tactor/driver.h"
#include "tactor/opening_turn.h"
#include "tactoroutput.h"
#include "tactorsettings.h"

#include <gst/gst.h>
#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

/// How tactorsink opens what it plays on: board, trace and calibration.
struct TactorOpening
{
  TactorSettings settings;
  std::unique_ptr<tactor::Driver> driver; ///< not open yet; null: it was opened
  tactor::PlannerSettings planner;        ///< with what was agreed on with the board, if it is open
  std::vector<tactor::MotorParameters> motors; ///< as measured; empty: no calibration
  tactor::Time latency{ 0 };                   ///< the longest on the way to a motor
  int tactors = 0;                             ///< of the open board
  std::unique_ptr<tactor::OpeningTurn> turn;   ///< null: it was taken
};

/// The part that waits for nothing: settings are checked and the calibration is read. Warns on the
/// element's bus where motors are slower than max-lead.
[[nodiscard]] tl::expected<TactorOpening, tactor::DriverError>
prepare_tactors(GstElement *element, const TactorSettings &settings);

/// The part that may take seconds, until `stop` is requested. `notify` is told of the board on any
/// thread of the driver's, from before this returns.
[[nodiscard]] tl::expected<TactorOutput, tactor::DriverError>
open_tactors(GstElement *element, TactorOpening &opening,
             std::function<void(const tactor::DriverEvent &)> notify, std::stop_token stop);
