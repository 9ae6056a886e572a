// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/sound_context.h"

namespace {

using Maps = std::shared_ptr<fusion::SoundMaps>;

/// Names the layout of fusion::SoundMaps, too: plugins of two versions do not meet.
constexpr const gchar *kType = "visuotactile.sound-maps." PACKAGE_VERSION;
constexpr const gchar *kField = "maps";

/// One type per process: each plugin has this code, and plugins stay loaded.
GType
maps_type()
{
  constexpr const gchar *kName = "VisuotactileSoundMaps";
  static const GType type = [] {
    const GType known = g_type_from_name(kName);
    if (known != 0)
      return known;
    return g_boxed_type_register_static(
        kName, [](gpointer maps) -> gpointer { return new Maps(*static_cast<Maps *>(maps)); },
        [](gpointer maps) { delete static_cast<Maps *>(maps); });
  }();
  return type;
}

Maps
known_to(GstElement *element)
{
  g_autoptr(GstContext) context = gst_element_get_context(element, kType);
  const GValue *value
      = context ? gst_structure_get_value(gst_context_get_structure(context), kField) : nullptr;
  return value && G_VALUE_HOLDS(value, maps_type()) ? *static_cast<Maps *>(g_value_get_boxed(value))
                                                    : nullptr;
}

} // namespace

Maps
sound_maps_of(GstElement *element)
{
  if (Maps known = known_to(element))
    return known;
  gst_element_post_message(element, gst_message_new_need_context(GST_OBJECT(element), kType));
  if (Maps known = known_to(element))
    return known;
  Maps maps = std::make_shared<fusion::SoundMaps>();
  GstContext *context = gst_context_new(kType, FALSE);
  gst_structure_set(gst_context_writable_structure(context), kField, maps_type(), &maps, nullptr);
  gst_element_set_context(element, context);
  gst_element_post_message(element, gst_message_new_have_context(GST_OBJECT(element), context));
  return maps;
}
