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

/// Board, trace and calibration of a play, before and after the board is open.
struct TactorOpening
{
  TactorSettings settings;
  std::unique_ptr<tactor::Driver> driver; ///< not yet open; null afterwards
  tactor::PlannerSettings planner;        ///< with latency and line of the board, once it is open
  std::vector<tactor::MotorParameters> motors;    ///< of the calibration; empty without one
  tactor::Time latency{ 0 };                      ///< longest one to a motor
  tactor::Time live_latency{ 0 };                 ///< that of a live source, whose picture waits
  int tactors = 0;                                ///< of the board, once it is open
  tactor::Layout layout;                          ///< of the board, once it is open
  std::shared_ptr<tactor::DeviceAccount> account; ///< of the board, once it is open; may be null
  std::unique_ptr<tactor::OpeningTurn> turn;      ///< null after the opening
};

/// The part that does not wait: checks the settings and reads the calibration. Posts a warning if
/// motors are slower than max-lead.
[[nodiscard]] tl::expected<TactorOpening, tactor::DriverError>
prepare_tactors(GstElement *element, const TactorSettings &settings);

/// The part that may take seconds, until `stop` is requested. `notify` is called on any thread of
/// the driver, also before this returns.
[[nodiscard]] tl::expected<TactorOutput, tactor::DriverError>
open_tactors(GstElement *element, TactorOpening &opening,
             std::function<void(const tactor::DriverEvent &)> notify, std::stop_token stop);
