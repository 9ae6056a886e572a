// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_VISUOTACTILE_SINK (gst_visuotactile_sink_get_type())
G_DECLARE_FINAL_TYPE(GstVisuotactileSink, gst_visuotactile_sink, GST, VISUOTACTILE_SINK, GstBin)

GST_ELEMENT_REGISTER_DECLARE(visuotactilesink);

G_END_DECLS
