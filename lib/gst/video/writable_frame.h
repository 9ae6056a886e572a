// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The frame itself if its metas may be changed, else one that has the same memory and metas.
/// gst_buffer_make_writable() copies memory that is not to be shared, as a GPU's, which takes long
/// or fails. Takes the frame; transfer full.
GstBuffer *writable_frame(GstBuffer *frame);
