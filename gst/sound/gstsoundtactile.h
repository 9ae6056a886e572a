// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_SOUND_TACTILE (gst_sound_tactile_get_type())
G_DECLARE_FINAL_TYPE(GstSoundTactile, gst_sound_tactile, GST, SOUND_TACTILE, GstElement)

G_END_DECLS
