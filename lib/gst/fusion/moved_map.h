// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <optional>

/// A map that moves as the tactile map of its frame does, whose grid it has. None: that map is
/// dropped.
inline std::optional<tactile::TactileMap>
moved_map(GstBuffer *frame, tactile::TactileMap map, GQuark type, gpointer data)
{
  if (GST_META_TRANSFORM_IS_COPY(type))
    return map;
  g_autoptr(GstBuffer) still = gst_buffer_new();
  g_autoptr(GstBuffer) moved = gst_buffer_new();
  GstTactileMeta *meta = gst_buffer_get_tactile_meta(frame);
  GstMetaTransformCopy whole = { FALSE, 0, static_cast<gsize>(-1) };
  if (!meta->meta.info->transform_func(still, &meta->meta, frame, _gst_meta_transform_copy, &whole))
    return std::nullopt;
  meta = gst_buffer_get_tactile_meta(still);
  std::ranges::copy(map.levels, meta->levels);
  if (!meta->meta.info->transform_func(moved, &meta->meta, still, type, data))
    return std::nullopt;
  meta = gst_buffer_get_tactile_meta(moved);
  std::copy_n(meta->levels, map.levels.size(), map.levels.begin());
  return map;
}

/// Registers the custom meta of a map that moves with the frame's, once per process: each plugin
/// has this code, and plugins stay loaded. Returns its name.
inline const gchar *
register_moved_map(const gchar *name, GstCustomMetaTransformFunction transform)
{
  static const gchar *tags[] = { "video", "size", "orientation", nullptr };
  if (gst_meta_get_info(name) == nullptr)
    gst_meta_register_custom(name, tags, transform, nullptr, nullptr);
  return name;
}
