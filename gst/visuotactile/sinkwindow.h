// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sinkparts.h"

/// visuotactilesink's GstVideoOverlay and GstNavigation: those of the video sink, wherever in it
/// they are.
void gst_visuotactile_sink_overlay_init(gpointer iface, gpointer data);
void gst_visuotactile_sink_navigation_init(gpointer iface, gpointer data);

/// Tells a new video sink what was asked for before there was one.
void gst_visuotactile_sink_apply_window(GstVisuotactileSink *self, GstElement *shown);
