// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_SUBTITLES (gst_tactile_subtitles_get_type())
G_DECLARE_FINAL_TYPE(GstTactileSubtitles, gst_tactile_subtitles, GST, TACTILE_SUBTITLES, GstBin)

G_END_DECLS
