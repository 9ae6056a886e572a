// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The preferred grid of maps. Elements query downstream for it, as caps of frames have no grid, and
// a tee mixes the preferences in caps. The grid of a stream of maps is one that its caps allow. A
// sink that prefers another grid than before sends an event upstream.
#pragma once

#include <gst/gst.h>

/// Grid of maps: the one that downstream of `pad` prefers, else the one nearest to the paper's
/// 3 × 3 that it accepts. Not serialized: does not wait for frames in queues.
void wanted_grid(GstPad *pad, guint *rows, guint *columns);

/// The same for maps on frames; 3 × 3 if no element downstream of `pad` plays their maps.
void wanted_grid_of_frames(GstPad *pad, guint *rows, guint *columns);
bool is_grid_query(GstQuery *query);
void answer_grid_query(GstQuery *query, guint rows, guint columns);

/// An event that makes upstream query again. The element that chooses the grid keeps it.
GstEvent *new_grid_event();
bool is_grid_event(const GstEvent *event);
