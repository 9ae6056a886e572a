// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The effect of a camera that travels; also a property of bins that hold a saliencytactile.
enum class CameraMode
{
  off,
  gentle,
};

/// One type per process, registered by the first plugin that needs it: plugins stay loaded.
inline GType
camera_mode_type()
{
  static const char *const kName = "GstSaliencyTactileCamera";
  static const GEnumValue values[] = {
    { static_cast<gint>(CameraMode::off), "Nothing", "off" },
    { static_cast<gint>(CameraMode::gentle),
      "A soft wave in the direction of travel, while no event is felt", "gentle" },
    { 0, nullptr, nullptr },
  };
  const GType known = g_type_from_name(kName);
  if (known != 0)
    return known;
  const GType type = g_enum_register_static(kName, values);
  gst_type_mark_as_plugin_api(type, static_cast<GstPluginAPIFlags>(0));
  return type;
}
