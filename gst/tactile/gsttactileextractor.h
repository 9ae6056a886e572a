// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_EXTRACTOR (gst_tactile_extractor_get_type())
G_DECLARE_FINAL_TYPE(GstTactileExtractor, gst_tactile_extractor, GST, TACTILE_EXTRACTOR, GstElement)

G_END_DECLS
