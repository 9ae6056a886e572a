// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_SYNTH (gst_tactile_synth_get_type())
G_DECLARE_FINAL_TYPE(GstTactileSynth, gst_tactile_synth, GST, TACTILE_SYNTH, GstElement)

GST_ELEMENT_REGISTER_DECLARE(tactilesynth);

G_END_DECLS
