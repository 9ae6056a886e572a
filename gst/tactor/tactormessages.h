// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"
#include "tactor/motor_limits.h"
#include "tactor/realtime/realtime_thread.h"
#include "tactoractuation.h"

#include <gst/gst.h>

// What tactorsink tells on its bus, and the contents of its property `actuation-stats`. Any thread
// may call these.

/// Why it did not open: an error message with GStreamer's code for it.
void tactor_post_open_error(GstElement *element, const tactor::DriverError &error);

/// What became of the board: a message for people, and `tactor-device-lost`, `tactor-device-found`
/// or `tactor-device-refused` for programs.
void tactor_post_device_event(GstElement *element, const tactor::DriverEvent &event);

/// What an update of a chair takes on its line.
struct TactorLineLoad
{
  std::size_t tactors = 0; ///< of the chair
  int bytes = 0;           ///< of an update of them all
  tactor::Time update{ 0 };
  tactor::Time at_once{ 0 };   ///< what those take that max-active lets change at once
  std::size_t most_active = 0; ///< with this max-active the line would carry all
};

/// That an update of all tactors takes long, which is of no account as long as `max-active` lets
/// fewer change at once; where it does not (`is_too_large`), a warning and `tactor-line-slow`.
void tactor_post_line_load(GstElement *element, const TactorLineLoad &load, bool is_too_large);

/// `tactor-lead-short`: a command that needs this lead was late.
void tactor_post_lead_short(GstElement *element, tactor::Time lead, tactor::Time late);

/// `tactor-stats`, at the end of the stream. Takes the structure.
void tactor_post_stats(GstElement *element, GstStructure *stats);

/// Property `actuation-stats`. Transfer full.
GstStructure *tactor_stats_new(const TactorActuation::Counters &counters,
                               const tactor::DriverStatus &board,
                               const tactor::LimitCounters &limited, tactor::Scheduling scheduling);
