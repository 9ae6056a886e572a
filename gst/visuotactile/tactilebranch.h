// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

/// A bin that takes a stream of tactile maps: a queue and a tactorsink. Its failures are no one
/// else's: an error becomes a warning, tactorsink is taken out until the next play (READY to
/// PAUSED), and what still comes is dropped. State changes and give-up on the application's thread
/// or GStreamer's async ones, maps on a streaming thread; what they share is under the object lock.
#define GST_TYPE_TACTILE_BRANCH (gst_tactile_branch_get_type())
G_DECLARE_FINAL_TYPE(GstTactileBranch, gst_tactile_branch, GST, TACTILE_BRANCH, GstBin)

/// Floating; NULL where there is no tactorsink.
GstTactileBranch *gst_tactile_branch_new(const gchar *name);

/// The tactorsink, whether it is in the bin at the moment or not; not owned by the caller.
GstElement *gst_tactile_branch_get_tactors(GstTactileBranch *self);

G_END_DECLS
