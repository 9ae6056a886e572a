// SPDX-License-Identifier: LGPL-2.1-or-later
#include "wantedgrid.h"

#include <gst/tactile/tactile.h>

#include <algorithm>

static constexpr guint kPaperSide = 3;
static constexpr const gchar *kName = "tactile-grid"; ///< of query and event

namespace {

/// False if no element downstream of `pad` prefers a grid. Behind a tee the first one counts.
bool
ask(GstPad *pad, guint *rows, guint *columns)
{
  g_autoptr(GstQuery) query
      = gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new_empty(kName));
  if (!gst_pad_peer_query(pad, query)
      || !gst_structure_get(gst_query_get_structure(query), "rows", G_TYPE_UINT, rows, "columns",
                            G_TYPE_UINT, columns, nullptr))
    return false;
  for (guint *side : { rows, columns })
    *side = std::clamp<guint>(*side, 1, GST_TACTILE_MAX_SIDE);
  return true;
}

bool
allows(GstCaps *caps, guint rows, guint columns)
{
  g_autoptr(GstCaps) maps
      = gst_caps_new_simple(GST_TACTILE_MAP_MEDIA_TYPE, "rows", G_TYPE_INT, static_cast<gint>(rows),
                            "columns", G_TYPE_INT, static_cast<gint>(columns), nullptr);
  return gst_caps_can_intersect(caps, maps);
}

} // namespace

void
wanted_grid(GstPad *pad, guint *rows, guint *columns)
{
  GstCaps *caps = gst_pad_get_pad_template_caps(pad);
  GstCaps *allowed = gst_pad_peer_query_caps(pad, caps);
  gst_caps_unref(caps);
  const bool asked = ask(pad, rows, columns) && allows(allowed, *rows, *columns);
  if (!asked)
    *rows = *columns = kPaperSide;
  if (!asked && !gst_caps_is_empty(allowed) && !gst_caps_is_any(allowed)) {
    allowed = gst_caps_truncate(gst_caps_make_writable(allowed));
    GstStructure *structure = gst_caps_get_structure(allowed, 0);
    gst_structure_fixate_field_nearest_int(structure, "rows", kPaperSide);
    gst_structure_fixate_field_nearest_int(structure, "columns", kPaperSide);
    gst_tactile_map_caps_parse(allowed = gst_caps_fixate(allowed), rows, columns, nullptr, nullptr);
  }
  gst_caps_unref(allowed);
}

void
wanted_grid_of_frames(GstPad *pad, guint *rows, guint *columns)
{
  if (!ask(pad, rows, columns))
    *rows = *columns = kPaperSide;
}

bool
is_grid_query(GstQuery *query)
{
  return GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM
         && gst_structure_has_name(gst_query_get_structure(query), kName);
}

void
answer_grid_query(GstQuery *query, guint rows, guint columns)
{
  gst_structure_set(gst_query_writable_structure(query), "rows", G_TYPE_UINT, rows, "columns",
                    G_TYPE_UINT, columns, nullptr);
}

GstEvent *
new_grid_event()
{
  return gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty(kName));
}

bool
is_grid_event(const GstEvent *event)
{
  return GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM
         && gst_structure_has_name(gst_event_get_structure(const_cast<GstEvent *>(event)), kName);
}
