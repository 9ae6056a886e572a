// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

/// Maps of the picture in, maps of picture and sound out. The maps of the sound are those that
/// `soundtactile` in the same pipeline has found until then; without one, maps pass. It does not
/// wait for sound. Maps of a live source are later by the latency that it reports.
#define GST_TYPE_SOUND_JOIN (gst_sound_join_get_type())
G_DECLARE_FINAL_TYPE(GstSoundJoin, gst_sound_join, GST, SOUND_JOIN, GstElement)

/// With the property `sound`, a sound_mode_type(). Floating.
GstElement *gst_sound_join_new(const gchar *name);

/// The most by which maps of a live source are later; 0 if no sound joins. Any thread.
GstClockTime gst_sound_join_most_latency(GstSoundJoin *self);

G_END_DECLS
