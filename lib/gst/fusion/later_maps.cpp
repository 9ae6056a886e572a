// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/later_maps.h"

#include "gst/fusion/moved_map.h"

#include <gst/tactile/tactile.h>

#include <vector>

namespace {

const gchar *meta_name();

constexpr const gchar *kMaps = "maps";

/// Moves them in the same way as the frame's map. Several pictures of one frame, as of compositor,
/// have none where the first had some, as their own maps were put together.
gboolean
transform(GstBuffer *dest, GstCustomMeta *meta, GstBuffer *frame, GQuark type, gpointer data,
          gpointer)
{
  if (later_maps(frame) == nullptr)
    return FALSE;
  if (gst_buffer_get_custom_meta(dest, meta_name()) != nullptr)
    return TRUE;
  if (GST_META_TRANSFORM_IS_COPY(type)) {
    const GstStructure *own = gst_custom_meta_get_structure(meta);
    GstCustomMeta *copy = gst_buffer_add_custom_meta(dest, meta_name());
    gst_structure_set_value(gst_custom_meta_get_structure(copy), kMaps,
                            gst_structure_get_value(own, kMaps));
    return TRUE;
  }
  std::vector<LaterMap> moved;
  for (LaterMap &each : read_later_maps(frame)) {
    std::optional<tactile::TactileMap> map = moved_map(frame, std::move(each.map), type, data);
    if (!map)
      return FALSE;
    moved.push_back({ each.after, *map });
  }
  set_later_maps(dest, moved);
  return TRUE;
}

const gchar *
meta_name()
{
  static const gchar *const name = register_moved_map("VisuotactileLaterMaps", transform);
  return name;
}

} // namespace

void
set_later_maps(GstBuffer *frame, std::span<const LaterMap> maps)
{
  GstCustomMeta *meta = gst_buffer_get_custom_meta(frame, meta_name());
  if (meta == nullptr && maps.empty())
    return;
  if (meta == nullptr)
    meta = gst_buffer_add_custom_meta(frame, meta_name());
  g_autoptr(GstBufferList) list = gst_buffer_list_new();
  for (const auto &[after, map] : maps) {
    GstBuffer *buffer = gst_tactile_map_buffer_new(map.levels.data(), map.levels.size());
    gst_buffer_set_tactile_frequency(buffer, map.frequency);
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(after.count());
    gst_buffer_list_add(list, buffer);
  }
  gst_structure_set(gst_custom_meta_get_structure(meta), kMaps, GST_TYPE_BUFFER_LIST, list,
                    nullptr);
}

GstBufferList *
later_maps(GstBuffer *frame)
{
  GstCustomMeta *meta = gst_buffer_get_custom_meta(frame, meta_name());
  const GValue *value
      = meta ? gst_structure_get_value(gst_custom_meta_get_structure(meta), kMaps) : nullptr;
  auto *maps = value ? static_cast<GstBufferList *>(g_value_get_boxed(value)) : nullptr;
  const bool any = maps && gst_buffer_list_length(maps) > 0 && gst_buffer_get_tactile_meta(frame);
  return any ? maps : nullptr;
}

std::vector<LaterMap>
read_later_maps(GstBuffer *frame)
{
  GstBufferList *maps = later_maps(frame);
  const GstTactileMeta *felt = gst_buffer_get_tactile_meta(frame);
  std::vector<LaterMap> read;
  for (guint i = 0; maps != nullptr && i < gst_buffer_list_length(maps); i++) {
    GstBuffer *buffer = gst_buffer_list_get(maps, i);
    tactile::TactileMap map(static_cast<int>(felt->rows), static_cast<int>(felt->columns));
    gst_buffer_extract(buffer, 0, map.levels.data(), map.levels.size() * sizeof(gfloat));
    map.frequency = gst_buffer_get_tactile_frequency(buffer);
    read.push_back({ visuotactile::Time(static_cast<gint64>(GST_BUFFER_PTS(buffer))), map });
  }
  return read;
}
