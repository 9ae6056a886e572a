// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"
#include "tactor/motor_limits.h"
#include "tactorscheduler.h"

#include <gst/gst.h>

// What tactorsink tells on its bus, and the contents of its property `actuation-stats`. Any thread may call these.

/// Why it did not open: an error message with GStreamer's code for it.
void tactor_post_open_error(GstElement *element, const tactor::DriverError &error);

/// What became of the board: a message for people, and `tactor-device-lost`, `tactor-device-found` or `tactor-device-refused` for programs.
void tactor_post_device_event(GstElement *element, const tactor::DriverEvent &event);

/// `tactor-lead-short`: a command that needs this lead was late.
void tactor_post_lead_short(GstElement *element, tactor::Time lead, tactor::Time late);

/// `tactor-stats`, at the end of the stream. Takes the structure.
void tactor_post_stats(GstElement *element, GstStructure *stats);

/// Property `actuation-stats`. Transfer full.
GstStructure *tactor_stats_new(const TactorScheduler::Counters &counters,
                               const tactor::DriverStatus &board,
                               const tactor::LimitCounters &limited, tactor::Scheduling scheduling);
