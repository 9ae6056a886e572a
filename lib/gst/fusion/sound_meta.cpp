// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/sound_meta.h"

#include "gst/fusion/moved_map.h"

#include <utility>

namespace {

constexpr const gchar *kLevels = "levels";

/// Moves the contribution of the sound in the same way as the frame's map.
gboolean
transform(GstBuffer *dest, GstCustomMeta *, GstBuffer *frame, GQuark type, gpointer data, gpointer)
{
  const GstTactileMeta *felt = gst_buffer_get_tactile_meta(frame);
  if (felt == nullptr || has_sound_meta(dest))
    return FALSE;
  std::optional<tactile::TactileMap> added = sound_meta(frame, felt->rows, felt->columns);
  if (added)
    added = moved_map(frame, std::move(*added), type, data);
  if (!added)
    return FALSE;
  add_sound_meta(dest, *added);
  return TRUE;
}

const gchar *
meta_name()
{
  static const gchar *const name = register_moved_map("VisuotactileSoundMeta", transform);
  return name;
}

} // namespace

void
add_sound_meta(GstBuffer *frame, const tactile::TactileMap &added)
{
  GstCustomMeta *meta = gst_buffer_add_custom_meta(frame, meta_name());
  g_autoptr(GBytes) levels
      = g_bytes_new(added.levels.data(), added.levels.size() * sizeof(added.levels.front()));
  gst_structure_set(gst_custom_meta_get_structure(meta), kLevels, G_TYPE_BYTES, levels, nullptr);
}

bool
has_sound_meta(GstBuffer *frame)
{
  return gst_buffer_get_custom_meta(frame, meta_name()) != nullptr;
}

std::optional<tactile::TactileMap>
sound_meta(GstBuffer *frame, guint rows, guint columns)
{
  GstCustomMeta *meta = gst_buffer_get_custom_meta(frame, meta_name());
  g_autoptr(GBytes) levels = nullptr;
  if (meta == nullptr
      || !gst_structure_get(gst_custom_meta_get_structure(meta), kLevels, G_TYPE_BYTES, &levels,
                            nullptr))
    return std::nullopt;
  tactile::TactileMap added(static_cast<int>(rows), static_cast<int>(columns));
  gsize size = 0;
  const auto *data = static_cast<const float *>(g_bytes_get_data(levels, &size));
  if (size != added.levels.size() * sizeof(float))
    return std::nullopt;
  std::copy_n(data, added.levels.size(), added.levels.begin());
  return added;
}
