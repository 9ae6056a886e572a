// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../properties.h"
#include "tactor/command_planner.h"

#include <gst/gst.h>
#include <gst/tactile/tactile.h>

#include <string>
#include <vector>

/// The properties of tactorsink. Not thread-safe.
struct TactorSettings
{
  static constexpr int kMaxTactors = GST_TACTILE_MAX_SIDE * GST_TACTILE_MAX_SIDE;

  std::string driver = "auto";
  std::string device;
  std::string trace_location;
  std::string calibration; ///< key file; empty: none
  tactor::PlannerSettings planner;
  bool mute = false;
  bool realtime = true;
  bool guardian = true;
  double delay = 0; ///< of all vibration, in ms
  tactor::Time ramp_in = std::chrono::milliseconds(100);
  std::string mapping_error; ///< why the last mapping was refused; empty: it was not

  /// Whether nothing is to be felt, whatever the maps are.
  bool is_silent() const
  {
    return mute || planner.intensity <= 0;
  }
  tactor::Time delay_time() const
  {
    return std::chrono::duration_cast<tactor::Time>(
        std::chrono::duration<double, std::milli>(delay));
  }
  tactor::Time ramp_in_time() const
  {
    return ramp_in;
  }
  /// Tactors that the mapping names, at least 1.
  int needed_tactors() const;

  /// All properties of tactorsink.
  static void install(GObjectClass *klass, const properties::Element<TactorSettings> &element);
};

/// Appends numbers to a value of GST_TYPE_ARRAY.
void tactor_ints_to_value(const std::vector<int> &numbers, GValue *value);
