// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/video/gstvideofilter.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_OVERLAY (gst_tactile_overlay_get_type())
G_DECLARE_FINAL_TYPE(GstTactileOverlay, gst_tactile_overlay, GST, TACTILE_OVERLAY, GstVideoFilter)

G_END_DECLS
