// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/base/gstbasesink.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTOR_SINK (gst_tactor_sink_get_type())
G_DECLARE_FINAL_TYPE(GstTactorSink, gst_tactor_sink, GST, TACTOR_SINK, GstBaseSink)

GST_ELEMENT_REGISTER_DECLARE(tactorsink);

G_END_DECLS
