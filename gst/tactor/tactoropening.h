// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"
#include "tactor/driver.h"
#include "tactor/opening_turn.h"
#include "tactorscheduler.h"
#include "tactorsettings.h"

#include <gst/gst.h>
#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

/// The tactors of a play, before the board is open.
struct TactorOpening
{
  TactorSettings settings;
  std::vector<tactor::MotorParameters> motors; ///< of the calibration; empty without one
  tactor::Time latency{ 0 };                   ///< longest one of a motor
  std::unique_ptr<tactor::Driver> driver;      ///< not yet open
  std::unique_ptr<tactor::OpeningTurn> turn;
};

/// The tactors of a play whose board is open.
struct OpenTactors
{
  tactor::PlannerSettings planner; ///< with latency and line of the board
  std::vector<tactor::MotorParameters> motors;
  int count;
  tactor::Layout layout;
  std::shared_ptr<tactor::DeviceAccount> account; ///< may be null
  tactor::Time latency;                           ///< longest one to a motor
  tactor::Time live_latency;                      ///< that of a live source, whose picture waits
};

/// The part that does not wait: checks the settings and reads the calibration. Posts a warning if
/// motors are slower than max-lead.
[[nodiscard]] tl::expected<TactorOpening, tactor::DriverError>
prepare_tactors(GstElement *element, const TactorSettings &settings);

/// The part that may take seconds, until `stop` is requested. `notify` is called on any thread of
/// the driver, also before this returns.
[[nodiscard]] tl::expected<std::pair<OpenTactors, TactorOutput>, tactor::DriverError>
open_tactors(GstElement *element, TactorOpening opening,
             std::function<void(const tactor::DriverEvent &)> notify, std::stop_token stop);
