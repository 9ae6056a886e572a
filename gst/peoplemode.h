// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// How saliencytactile looks for people; also a property of bins that hold one.
enum class PeopleMode
{
  off,
  fast,
  thorough,
};

/// One type per process, registered by the first plugin that needs it: plugins stay loaded.
inline GType
people_mode_type()
{
  static const char *const kName = "GstSaliencyTactilePeople";
  static const GEnumValue values[] = {
    { static_cast<gint>(PeopleMode::off), "No faces", "off" },
    { static_cast<gint>(PeopleMode::fast), "Faces from about a sixteenth of the picture on",
      "fast" },
    { static_cast<gint>(PeopleMode::thorough), "Smaller faces too, for twice the work",
      "thorough" },
    { 0, nullptr, nullptr },
  };
  const GType known = g_type_from_name(kName);
  if (known != 0)
    return known;
  const GType type = g_enum_register_static(kName, values);
  gst_type_mark_as_plugin_api(type, static_cast<GstPluginAPIFlags>(0));
  return type;
}
