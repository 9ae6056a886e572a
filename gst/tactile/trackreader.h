// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"

#include <gst/base/gstaggregator.h>

#include <optional>
#include <vector>

/// The track of a film: reads the maps of an aggregator's pad by the film's running time, in ns.
/// Its functions are called on the aggregator's thread, or while that is stopped.
class TrackReader
{
public:
  /// A part of a frame: the track has this map from `begin` on.
  struct Part
  {
    gint64 begin = 0;
    tactile::TactileMap map;
    bool is_sound = false; ///< kSoundMap
  };

  /// Takes the grid of the track's caps. False if they are not those of a tactile map.
  bool set_caps(const GstCaps *caps);

  /// Whether the track had caps.
  bool has_grid() const
  {
    return rows > 0;
  }

  /// Forgets the map that was read last, as for a new segment.
  void clear()
  {
    held.reset();
  }

  /// Forgets the grid, too.
  void reset();

  /// Adds to `parts` what the track, felt `offset` later, has in [begin, end): a part for each
  /// change, up to the first sound. GST_AGGREGATOR_FLOW_NEED_DATA if the track is not known so far
  /// yet; a later call with the same parts goes on. GST_FLOW_ERROR, with a message, for a buffer
  /// that is no map.
  GstFlowReturn add_parts(GstAggregatorPad *pad, gint64 offset, gint64 begin, gint64 end,
                          std::vector<Part> &parts);

  /// The track at a time up to which it was read; silence where it has nothing.
  Part part_at(gint64 time) const;

  /// Running time of a buffer; none if it is before the segment or has no time.
  static std::optional<gint64> time_of(GstAggregatorPad *pad, GstClockTime pts);

  /// Running time of the end of a buffer that begins at the running time `begin`; none without a
  /// duration.
  static std::optional<gint64> end_of(GstAggregatorPad *pad, const GstBuffer *buffer,
                                      GstClockTime duration, gint64 begin);

private:
  struct Held
  {
    Part part;
    std::optional<gint64> end; ///< none: until the next map

    bool covers(gint64 time) const
    {
      return !end || time < *end;
    }
  };

  tactile::TactileMap silence() const;
  std::optional<tactile::TactileMap> read_map(GstAggregatorPad *pad, GstBuffer *buffer) const;
  GstFlowReturn advance(GstAggregatorPad *pad, gint64 offset, gint64 time);
  gint64 next_change(GstAggregatorPad *pad, gint64 offset, gint64 time) const;

  guint rows = 0;
  guint columns = 0;
  std::optional<Held> held;
};

/// Whether a buffer that GstAggregator made of a GAP event stands for lost data.
bool is_lost(GstBuffer *gap);
