// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

#include <gst/gst.h>

#include <optional>

/// A map of a stream that has sound in it, or ends one that had: tactors take it at once, between
/// the blocks of their rate.
inline constexpr GstBufferFlags kSoundMap = GST_BUFFER_FLAG_MARKER;

/// Says of a frame what the sound added to its tactile map, which has the same grid. The frame is
/// writable.
void add_sound_meta(GstBuffer *frame, const tactile::TactileMap &added);

/// Whether sound is in the frame's tactile map, or ended before it.
bool has_sound_meta(GstBuffer *frame);

/// The contribution of the sound; none without it, or in another grid than this one.
std::optional<tactile::TactileMap> sound_meta(GstBuffer *frame, guint rows, guint columns);
