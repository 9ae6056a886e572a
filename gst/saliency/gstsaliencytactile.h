// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/base/gstbasetransform.h>

G_BEGIN_DECLS

#define GST_TYPE_SALIENCY_TACTILE (gst_saliency_tactile_get_type())
G_DECLARE_FINAL_TYPE(GstSaliencyTactile, gst_saliency_tactile, GST, SALIENCY_TACTILE,
                     GstBaseTransform)

GST_ELEMENT_REGISTER_DECLARE(saliencytactile);

G_END_DECLS
