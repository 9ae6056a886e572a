// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactilebranch.h"

#include <gst/video/video.h>

class ChairProperties;

/// The window that the application has set for the video sink; kept until there is one.
struct SinkWindow
{
  gboolean has_handle;
  guintptr handle;
  gboolean ignores_events;
  gboolean has_rectangle;
  GstVideoRectangle rectangle;
};

/// visuotactilesink. Properties and window: any thread. State changes: the application's thread or
/// GStreamer's async ones.
typedef struct _GstVisuotactileSink GstVisuotactileSink;
struct _GstVisuotactileSink
{
  GstBin parent;

  /* Made at init; placeholder changes with the state. */
  GstPad *sinkpad;
  GstElement *frames; ///< queue before the analysis; NULL, as the next, where a plugin is missing
  GstElement *analysis;
  GstElement *extractor;
  GstElement *queue;
  GstTactileBranch *branch;
  ChairProperties *properties;
  GstElement *placeholder; ///< in place of the video sink; NULL while there is one

  /* Object lock. */
  GstElement *wanted;     ///< video-sink as set; owned
  GstElement *shown;      ///< the video sink in the bin; owned
  GstStructure *settings; ///< properties that were set here for the video sink
  SinkWindow window;
};

#define GST_VISUOTACTILE_SINK_CAST(object) (reinterpret_cast<GstVisuotactileSink *>(object))

/// tactorsink, also while it is out of the bin; NULL where there is none. Transfer none.
GstElement *gst_visuotactile_sink_get_tactors(GstVisuotactileSink *self);

/// The video sink in the bin, or NULL. Transfer full.
GstElement *gst_visuotactile_sink_ref_shown(GstVisuotactileSink *self);
