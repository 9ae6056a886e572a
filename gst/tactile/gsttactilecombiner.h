// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/base/gstaggregator.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_COMBINER (gst_tactile_combiner_get_type())
G_DECLARE_FINAL_TYPE(GstTactileCombiner, gst_tactile_combiner, GST, TACTILE_COMBINER, GstAggregator)

G_END_DECLS
