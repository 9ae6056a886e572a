// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "soundjoin.h"

#include <gst/gst.h>

G_BEGIN_DECLS

/// A bin of a leaky queue, a sound join and a tactorsink that takes tactile maps, or one with the
/// analysis behind the queue that takes frames. Its errors become warnings: all but the queue is
/// removed until the next READY to PAUSED, and buffers are dropped. State changes on the
/// application's thread or GStreamer's async ones, buffers on a streaming thread; shared state is
/// under the object lock.
#define GST_TYPE_TACTILE_BRANCH (gst_tactile_branch_get_type())
G_DECLARE_FINAL_TYPE(GstTactileBranch, gst_tactile_branch, GST, TACTILE_BRANCH, GstBin)

/// Floating; NULL if tactorsink is missing.
GstTactileBranch *gst_tactile_branch_new(const gchar *name);

/// A branch that takes frames. Floating; NULL if saliencytactile, tactileextractor or tactorsink is
/// missing.
GstTactileBranch *gst_tactile_branch_new_with_analysis(const gchar *name);

/// The tactorsink, also while it is out of the bin. Transfer none.
GstElement *gst_tactile_branch_get_tactors(GstTactileBranch *self);

/// The saliencytactile, also while it is out of the bin; NULL where maps come in. Transfer none.
GstElement *gst_tactile_branch_get_analysis(GstTactileBranch *self);

/// Where the sound joins, also while it is out of the bin. Transfer none.
GstSoundJoin *gst_tactile_branch_get_sound(GstTactileBranch *self);

/// The pad that maps leave for the tactorsink. Transfer full.
GstPad *gst_tactile_branch_get_maps_pad(GstTactileBranch *self);

G_END_DECLS
