// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Lets the streaming threads of a pipeline give way to others: Linux schedules them as a batch
/// (SCHED_BATCH). It takes the bus's sync handler.
void run_in_background(GstElement *pipeline);

/// Limits each element that is added from now on to one thread.
void use_one_thread(GstElement *pipeline);

/// Lets the element `film` of film_source() decode the picture only.
void decode_picture_only(GstElement *pipeline);
