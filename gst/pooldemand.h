// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Asks, in an answered ALLOCATION query, for as many more buffers as are held back for `time`, and
/// `more` of them.
void demand_buffers(GstQuery *query, GstClockTime time, guint more = 1);
