// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "gstvisuotactilesink.h"
#include "sinkwindow.h"
#include "tactilebranch.h"

/// Properties and the window on any thread, the state on the application's or GStreamer's async
/// ones.
struct _GstVisuotactileSink
{
  GstBin parent;

  /* As made at init; placeholder while the state changes. */
  GstPad *sinkpad;
  GstElement *analysis; ///< NULL where an element is missing, as all of these
  GstElement *queue;
  GstTactileBranch *branch;
  GstElement *placeholder; ///< where the video sink will be; NULL while there is one

  /* Object lock. */
  GstElement *wanted;     ///< video-sink as set; owned
  GstElement *shown;      ///< the video sink that is in the bin; owned
  GstStructure *settings; ///< the video sink's properties, as far as they were set here
  SinkWindow window;
};

/// tactorsink, whether it is in the bin at the moment or not, or NULL where there is none; not
/// owned by the caller.
GstElement *gst_visuotactile_sink_get_tactors(GstVisuotactileSink *self);

/// The video sink that is in the bin, or NULL; transfer full.
GstElement *gst_visuotactile_sink_ref_shown(GstVisuotactileSink *self);
