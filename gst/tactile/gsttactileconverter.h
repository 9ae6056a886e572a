// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_CONVERTER (gst_tactile_converter_get_type())
G_DECLARE_FINAL_TYPE(GstTactileConverter, gst_tactile_converter, GST, TACTILE_CONVERTER, GstElement)

G_END_DECLS
