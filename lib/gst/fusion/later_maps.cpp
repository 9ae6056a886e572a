// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/later_maps.h"

#include "gst/fusion/moved_map.h"

#include <gst/tactile/tactile.h>

#include <vector>

namespace {

constexpr const gchar *kMaps = "maps";

std::optional<LaterMap>
read(GstBuffer *buffer, const GstTactileMeta &grid)
{
  g_autofree gfloat *levels = nullptr;
  gsize count = 0;
  if (!gst_tactile_map_buffer_get_levels(buffer, grid.rows, grid.columns, &levels, &count))
    return std::nullopt;
  tactile::TactileMap map(static_cast<int>(grid.rows), static_cast<int>(grid.columns));
  std::copy_n(levels, count, map.levels.begin());
  map.frequency = gst_buffer_get_tactile_frequency(buffer);
  return LaterMap{ visuotactile::Time(static_cast<gint64>(GST_BUFFER_PTS(buffer))), map };
}

/// Moves them in the same way as the frame's map.
gboolean
transform(GstBuffer *dest, GstCustomMeta *, GstBuffer *frame, GQuark type, gpointer data, gpointer)
{
  const GstTactileMeta *felt = gst_buffer_get_tactile_meta(frame);
  GstBufferList *maps = later_maps(frame);
  if (felt == nullptr || maps == nullptr || later_maps(dest) != nullptr)
    return FALSE;
  std::vector<LaterMap> moved;
  for (guint i = 0; i < gst_buffer_list_length(maps); i++) {
    std::optional<LaterMap> each = read(gst_buffer_list_get(maps, i), *felt);
    std::optional<tactile::TactileMap> map
        = each ? moved_map(frame, std::move(each->map), type, data) : std::nullopt;
    if (!map)
      return FALSE;
    moved.push_back({ each->after, *map });
  }
  set_later_maps(dest, moved);
  return TRUE;
}

/// Registered once per process, as in sound_meta.cpp.
const gchar *
meta_name()
{
  static const gchar *const name = [] {
    constexpr const gchar *kName = "VisuotactileLaterMaps";
    static const gchar *tags[] = { "video", "size", "orientation", nullptr };
    if (gst_meta_get_info(kName) == nullptr)
      gst_meta_register_custom(kName, tags, transform, nullptr, nullptr);
    return kName;
  }();
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
  const GstTactileMeta *felt = gst_buffer_get_tactile_meta(frame);
  const GValue *value
      = meta ? gst_structure_get_value(gst_custom_meta_get_structure(meta), kMaps) : nullptr;
  auto *maps = value ? static_cast<GstBufferList *>(g_value_get_boxed(value)) : nullptr;
  // Another element may have replaced the frame's own map.
  const bool fit = felt && maps && gst_buffer_list_length(maps) > 0
                   && gst_buffer_get_size(gst_buffer_list_get(maps, 0))
                          == gsize{ felt->rows } * felt->columns * sizeof(gfloat);
  return fit ? maps : nullptr;
}
