// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"
#include "tactor/motor_limits.h"
#include "tactor/realtime/scheduling.h"
#include "tactoractuation.h"

#include <gst/gst.h>

// Messages of tactorsink, and the contents of its property `actuation-stats`. Any thread.

/// An error message with GStreamer's code for the error.
void tactor_post_open_error(GstElement *element, const tactor::DriverError &error);

/// An info or warning message, and `tactor-device-lost`, `tactor-device-found` or
/// `tactor-device-refused` for programs.
void tactor_post_device_event(GstElement *element, const tactor::DriverEvent &event);

/// Time of a chair's levels on its line.
struct TactorLineLoad
{
  std::size_t tactors = 0; ///< of the chair
  int bytes = 0;           ///< of an update of them all
  tactor::Time update{ 0 };
  tactor::Time at_once{ 0 };   ///< as many as max-active lets change at once
  std::size_t most_active = 0; ///< largest max-active for which the line is fast enough
};

/// An update of all tactors takes long: an info message, as long as `max-active` lets few enough
/// change at once. Otherwise (`is_too_large`) a warning and `tactor-line-slow`.
void tactor_post_line_load(GstElement *element, const TactorLineLoad &load, bool is_too_large);

/// `tactor-lead-short`: a command that needs this lead was late.
void tactor_post_lead_short(GstElement *element, tactor::Time lead, tactor::Time late);

/// `tactor-stats`, at the end of the stream. Transfer full.
void tactor_post_stats(GstElement *element, GstStructure *stats);

/// The value of `actuation-stats`. Transfer full.
GstStructure *tactor_stats_new(const TactorActuation::Counters &counters,
                               const tactor::DriverStatus &board, tactor::Time latency,
                               const tactor::LimitCounters &limited, tactor::Scheduling scheduling);
