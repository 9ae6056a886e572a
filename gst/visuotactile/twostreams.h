// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Lets a stream follow another one through a `queue` while the end of the first still waits in it,
/// as in a gapless play. GstQueue (1.22 to 1.28) stops for good then: STREAM_START "restarts" a
/// thread that runs, which then comes to the old EOS and pauses.
///
/// Therefore the queue gets EOS as a custom event, and its source pad makes EOS of it. A queue that
/// leaks, or whose buffers are answered with EOS, may drop it as it drops data.
void let_streams_follow(GstElement *queue);
