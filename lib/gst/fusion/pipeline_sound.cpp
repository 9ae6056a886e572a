// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/pipeline_sound.h"

#include "gst/fusion/topmost.h"

#include <utility>

namespace {

using Maps = std::shared_ptr<fusion::SoundMaps>;

/// Names the layout of fusion::SoundMaps, too: plugins of two versions do not meet.
constexpr const gchar *kKey = "visuotactile.sound-maps." PACKAGE_VERSION;

std::unique_ptr<Maps>
known_to(GstObject *top, GQuark key)
{
  const auto copy = [](gpointer maps, gpointer) -> gpointer {
    return maps ? new Maps(*static_cast<Maps *>(maps)) : nullptr;
  };
  return std::unique_ptr<Maps>(
      static_cast<Maps *>(g_object_dup_qdata(G_OBJECT(top), key, copy, nullptr)));
}

} // namespace

/// As data of the GObject, not as a GstContext: playbin's set_context() takes a lock that its state
/// change holds while it waits for the stream, on which decoders change their states.
Maps
sound_maps_of(GstElement *element)
{
  const GQuark key = g_quark_from_static_string(kKey); // plugins stay loaded
  g_autoptr(GstObject) top = topmost(GST_OBJECT(element));
  std::unique_ptr<Maps> maps = known_to(top, key);
  while (!maps) {
    auto made = std::make_unique<Maps>(std::make_shared<fusion::SoundMaps>());
    const auto free = [](gpointer data) {
      delete static_cast<Maps *>(data);
    };
    // If two elements call at once, one gets the maps that the other made.
    if (g_object_replace_qdata(G_OBJECT(top), key, nullptr, made.get(), free, nullptr))
      static_cast<void>(made.release());
    maps = known_to(top, key);
  }
  return *maps;
}
