// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_KLV_DEC (gst_tactile_klv_dec_get_type())
G_DECLARE_FINAL_TYPE(GstTactileKlvDec, gst_tactile_klv_dec, GST, TACTILE_KLV_DEC, GstElement)

G_END_DECLS
