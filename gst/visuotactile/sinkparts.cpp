// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sinkparts.h"

GstElement *
gst_visuotactile_sink_get_tactors(GstVisuotactileSink *self)
{
  return self->branch ? gst_tactile_branch_get_tactors(self->branch) : nullptr;
}

GstElement *
gst_visuotactile_sink_ref_shown(GstVisuotactileSink *self)
{
  GST_OBJECT_LOCK(self);
  GstElement *shown = self->shown ? GST_ELEMENT(gst_object_ref(self->shown)) : nullptr;
  GST_OBJECT_UNLOCK(self);
  return shown;
}
