// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTOR_AUDIO_SINK (gst_tactor_audio_sink_get_type())
G_DECLARE_FINAL_TYPE(GstTactorAudioSink, gst_tactor_audio_sink, GST, TACTOR_AUDIO_SINK, GstBin)

GST_ELEMENT_REGISTER_DECLARE(tactoraudiosink);

G_END_DECLS
