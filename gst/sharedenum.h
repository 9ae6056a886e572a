// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The enumeration of a property that elements of several plugins have: one type per process,
/// registered by the first plugin that needs it. Plugins stay loaded. `values` must live as long.
inline GType
shared_enum_type(const char *name, const GEnumValue *values)
{
  const GType known = g_type_from_name(name);
  if (known != 0)
    return known;
  const GType type = g_enum_register_static(name, values);
  gst_type_mark_as_plugin_api(type, static_cast<GstPluginAPIFlags>(0));
  return type;
}
