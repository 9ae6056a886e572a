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

/// One per process, held while pipelines are asked and told: of two elements that ask at once, one
/// finds what the other made. Plugins stay loaded, and each has this code.
class Turn
{
public:
  Turn()
  {
    g_rec_mutex_lock(mutex());
  }
  ~Turn()
  {
    g_rec_mutex_unlock(mutex());
  }
  Turn(const Turn &) = delete;
  Turn &operator=(const Turn &) = delete;

private:
  static GRecMutex *mutex()
  {
    static GRecMutex *const mutex = [] {
      const GQuark name = g_quark_from_static_string("visuotactile.sound-maps");
      auto *registry = G_OBJECT(gst_registry_get()); // lives as long as the process
      auto *made = g_new(GRecMutex, 1);
      g_rec_mutex_init(made);
      if (g_object_replace_qdata(registry, name, nullptr, made, nullptr, nullptr))
        return made;
      g_rec_mutex_clear(made);
      g_free(made);
      return static_cast<GRecMutex *>(g_object_get_qdata(registry, name));
    }();
    return mutex;
  }
};

/// The pipeline, or what is in place of it. Transfer full.
GstElement *
topmost(GstElement *element)
{
  auto *top = GST_ELEMENT(gst_object_ref(element));
  while (GstObject *parent = gst_object_get_parent(GST_OBJECT(top))) {
    gst_object_unref(top);
    top = GST_ELEMENT(parent);
  }
  return top;
}

} // namespace

Maps
sound_maps_of(GstElement *element)
{
  const Turn turn;
  if (Maps known = known_to(element))
    return known;
  g_autoptr(GstElement) top = topmost(element);
  if (Maps known = known_to(top))
    return known;
  Maps maps = std::make_shared<fusion::SoundMaps>();
  g_autoptr(GstContext) context = gst_context_new(kType, FALSE);
  gst_structure_set(gst_context_writable_structure(context), kField, maps_type(), &maps, nullptr);
  gst_element_set_context(top, context); // a bin gives it to all that is in it
  return maps;
}
