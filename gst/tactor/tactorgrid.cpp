// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorgrid.h"

#include "../tactile/wantedgrid.h"

#include <gst/tactile/tactile.h>

GST_DEBUG_CATEGORY_EXTERN(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

TactorGrid::TactorGrid(GstPad *pad) : pad_(pad)
{
}

void
TactorGrid::set(const tactor::Layout &layout)
{
  GST_OBJECT_LOCK(pad_);
  const bool is_new = layout.rows != layout_.rows || layout.columns != layout_.columns;
  layout_ = layout;
  GST_OBJECT_UNLOCK(pad_);
  if (!is_new)
    return;
  GST_INFO_OBJECT(pad_, "the device's grid is %d x %d", layout.rows, layout.columns);
  gst_pad_push_event(pad_, new_grid_event());
}

GstCaps *
TactorGrid::caps(GstCaps *filter) const
{
  GstCaps *caps = gst_pad_get_pad_template_caps(pad_);
  if (const tactor::Layout grid = layout(); grid.tactors() > 0) {
    GstCaps *preferred = gst_caps_new_simple(
        GST_TACTILE_MAP_MEDIA_TYPE, "rows", G_TYPE_INT, grid.rows, "columns", G_TYPE_INT,
        grid.columns, "framerate", GST_TYPE_FRACTION_RANGE, 0, 1, G_MAXINT, 1, nullptr);
    caps = gst_caps_merge(preferred, caps);
  }
  if (filter == nullptr)
    return caps;
  GstCaps *filtered = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return filtered;
}

bool
TactorGrid::answer(GstQuery *query) const
{
  const tactor::Layout grid = layout();
  if (!is_grid_query(query) || grid.tactors() == 0)
    return false;
  answer_grid_query(query, static_cast<guint>(grid.rows), static_cast<guint>(grid.columns));
  return true;
}

tactor::Layout
TactorGrid::layout() const
{
  GST_OBJECT_LOCK(pad_);
  const tactor::Layout layout = layout_;
  GST_OBJECT_UNLOCK(pad_);
  return layout;
}
