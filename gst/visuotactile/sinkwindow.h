// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sinkparts.h"

/// Interfaces of visuotactilesink, forwarded to the element in the video sink that implements them.
void gst_visuotactile_sink_overlay_init(gpointer iface, gpointer data);
void gst_visuotactile_sink_navigation_init(gpointer iface, gpointer data);

/// Applies the window settings of before there was a video sink.
void gst_visuotactile_sink_apply_window(GstVisuotactileSink *self, GstElement *shown);
