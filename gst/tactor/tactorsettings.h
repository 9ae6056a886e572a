// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"

#include <gst/gst.h>
#include <gst/tactile/tactile.h>

#include <string>
#include <vector>

/// tactorsink's properties.
enum TactorProperty : guint
{
  TACTOR_PROP_DRIVER = 1,
  TACTOR_PROP_DEVICE,
  TACTOR_PROP_RATE,
  TACTOR_PROP_COMPENSATION,
  TACTOR_PROP_MAX_LEAD,
  TACTOR_PROP_VOLTAGE_MAX,
  TACTOR_PROP_VOLTAGE_MIN,
  TACTOR_PROP_INTENSITY,
  TACTOR_PROP_MUTE,
  TACTOR_PROP_MAPPING,
  TACTOR_PROP_MAX_ON_TIME,
  TACTOR_PROP_MAX_DUTY,
  TACTOR_PROP_MAX_ACTIVE,
  TACTOR_PROP_RAMP_IN,
  TACTOR_PROP_KICK_START,
  TACTOR_PROP_CALIBRATION,
  TACTOR_PROP_TRACE_LOCATION,
  TACTOR_PROP_REALTIME,
  TACTOR_PROP_STATS,
};

/// What the user of tactorsink sets, and how that looks as properties of a GObject. Not
/// thread-safe: the element guards it.
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
  tactor::Time ramp_in = std::chrono::milliseconds(100);

  std::string
      mapping_error; ///< why the mapping last set cannot be read, in one line; empty: it can

  /// Tactors that the mapping names, at least 1.
  int needed_tactors() const;

  /// All of TactorProperty, with their texts, ranges and defaults.
  static void install(GObjectClass *klass);

  /// Sets or gets a property. False if it is none of these: TACTOR_PROP_STATS is the element's own.
  bool set(guint id, const GValue *value);
  bool get(guint id, GValue *value) const;

private:
  void set_mapping(const std::string &text);
};

/// Appends numbers to a value of GST_TYPE_ARRAY.
void tactor_ints_to_value(const std::vector<int> &numbers, GValue *value);
