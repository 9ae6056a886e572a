// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_VISUOTACTILE_DECODER (gst_visuotactile_decoder_get_type())
G_DECLARE_FINAL_TYPE(GstVisuotactileDecoder, gst_visuotactile_decoder, GST, VISUOTACTILE_DECODER,
                     GstBin)
GST_ELEMENT_REGISTER_DECLARE(visuotactiledecoder);

G_END_DECLS
