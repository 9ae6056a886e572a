// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/video/writable_frame.h"

namespace {

bool
is_shared_by_copies(GstBuffer *frame)
{
  for (guint i = 0; i < gst_buffer_n_memory(frame); i++)
    if (GST_MEMORY_IS_NO_SHARE(gst_buffer_peek_memory(frame, i)))
      return false;
  return true;
}

gboolean
copy_meta(GstBuffer *frame, GstMeta **meta, gpointer copy)
{
  GstMetaTransformCopy whole{ FALSE, 0, static_cast<gsize>(-1) };
  if ((*meta)->info->transform_func)
    (*meta)->info->transform_func(static_cast<GstBuffer *>(copy), *meta, frame,
                                  _gst_meta_transform_copy, &whole);
  return TRUE;
}

} // namespace

GstBuffer *
writable_frame(GstBuffer *frame)
{
  if (gst_buffer_is_writable(frame) || is_shared_by_copies(frame))
    return gst_buffer_make_writable(frame);
  GstBuffer *copy = gst_buffer_new();
  gst_buffer_copy_into(
      copy, frame,
      static_cast<GstBufferCopyFlags>(GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS), 0,
      static_cast<gsize>(-1));
  for (guint i = 0; i < gst_buffer_n_memory(frame); i++)
    gst_buffer_append_memory(copy, gst_buffer_get_memory(frame, i));
  gst_buffer_foreach_meta(frame, copy_meta, copy);
  gst_buffer_add_parent_buffer_meta(copy, frame); // its pool waits for the memory
  gst_buffer_unref(frame);
  return copy;
}
