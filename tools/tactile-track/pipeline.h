// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "gst/cues/cue_stream.h"
#include "tracks/track.h"

#include <gst/gst.h>

#include <memory>
#include <string>

struct GstUnref
{
  void operator()(gpointer object) const
  {
    gst_object_unref(object);
  }
};
template <typename T> using Owned = std::unique_ptr<T, GstUnref>;

/// A pipeline of a launch line. Throws std::runtime_error.
Owned<GstElement> make_pipeline(const std::string &line);

/// An element of it by its name.
Owned<GstElement> element(const Owned<GstElement> &pipeline, const char *name);

/// Gives an appsrc the whole track as cues that follow each other without gaps, silent ones too,
/// and the end of stream. It must not have been started.
void feed_track(GstElement *appsrc, const tactile::Track &track, CueForm form);

/// Plays to the end of the stream. Progress in percent of `duration` (if known) goes to the
/// terminal on standard error. Throws std::runtime_error with what an element said; false if it was
/// stopped by SIGINT or SIGTERM.
bool run_to_end(const Owned<GstElement> &pipeline, GstClockTime duration, bool quiet);
