// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Lets the times of the frames on a pad advance. GStreamer 1.22's decoder of GIF gives each frame
/// the time 0, and some containers have the times of a few frames only: a frame without a time, or
/// with that of the one before it, begins where the one before it ends.
void let_times_advance(GstPad *pad);
