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

/// Says of a frame which maps follow its own within it, in order; they have the same grid. The
/// frame is writable, and has its own map, with which they are replaced. They stay in one process.
void set_later_maps(GstBuffer *frame, std::span<const LaterMap> maps);

/// These maps as buffers of a stream of maps, whose PTS is `after`. Null: none. Transfer none.
GstBufferList *later_maps(GstBuffer *frame);

std::vector<LaterMap> read_later_maps(GstBuffer *frame);
