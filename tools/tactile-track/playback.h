// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/pipeline.h"
#include "gst/cues/cue_stream.h"
#include "tracks/track.h"

/// Pushes the whole track into an appsrc as maps, then end of stream. Before the appsrc starts.
/// `start`: the running time of the film's 0:00 (StartTimes::running).
void feed_track(GstElement *appsrc, const tactile::Track &track, tactile::Time start);

/// Plays to the end of the stream, with progress on a terminal in percent of `duration` where that
/// is known. Throws std::runtime_error with what an element reports; false after SIGINT or SIGTERM.
bool run_to_end(const Pipeline &pipeline, GstClockTime duration, bool quiet);
