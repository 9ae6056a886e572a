// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/tactile_map.h"

#include <gst/gst.h>

#include <span>
#include <vector>

/// A map that is felt from a time within its frame on.
struct LaterMap
{
  visuotactile::Time after; ///< in the time of the frame's PTS
  tactile::TactileMap map;
};

/// Sets the maps that follow a frame's own map within the frame, in order and with the same grid.
/// Requires a writable frame with a map of its own; replacing that map drops them. A frame that
/// goes to another process loses them.
void set_later_maps(GstBuffer *frame, std::span<const LaterMap> maps);

/// These maps as buffers of a stream of maps, whose PTS is `after`. Null: none. Transfer none.
GstBufferList *later_maps(GstBuffer *frame);

std::vector<LaterMap> read_later_maps(GstBuffer *frame);
