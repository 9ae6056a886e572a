// SPDX-License-Identifier: LGPL-2.1-or-later
#include "wantedgrid.h"

#include <gst/tactile/tactile.h>

void
wanted_grid(GstPad *pad, guint *rows, guint *columns)
{
  constexpr gint kPaperSide = 3;

  *rows = *columns = kPaperSide;
  GstCaps *caps = gst_pad_get_pad_template_caps(pad);
  GstCaps *allowed = gst_pad_peer_query_caps(pad, caps);
  gst_caps_unref(caps);
  if (!gst_caps_is_empty(allowed) && !gst_caps_is_any(allowed)) {
    allowed = gst_caps_truncate(gst_caps_make_writable(allowed));
    GstStructure *structure = gst_caps_get_structure(allowed, 0);
    gst_structure_fixate_field_nearest_int(structure, "rows", kPaperSide);
    gst_structure_fixate_field_nearest_int(structure, "columns", kPaperSide);
    gst_tactile_map_caps_parse(allowed = gst_caps_fixate(allowed), rows, columns, nullptr, nullptr);
  }
  gst_caps_unref(allowed);
}
