// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The topmost parent of an object, usually its pipeline; without a parent the object itself.
/// Transfer full. Any thread, with no object lock held: it takes those of the object and its
/// parents one after the other, each for a moment, and no other lock.
///
/// A state change or a streaming thread takes no state lock of the topmost object, nor another lock
/// that blocks: the thread that changes a pipeline's state holds those of the pipeline and waits
/// for that of the stream.
inline GstObject *
topmost(GstObject *object)
{
  auto *top = GST_OBJECT(gst_object_ref(object));
  while (GstObject *parent = gst_object_get_parent(top)) {
    gst_object_unref(top);
    top = parent;
  }
  return top;
}
