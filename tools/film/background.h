// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Lets the streaming threads of a pipeline give way to others: Linux schedules them as a batch
/// (SCHED_BATCH). It takes the bus's sync handler.
void run_in_background(GstElement *pipeline);
