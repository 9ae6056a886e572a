// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/gst.h>

#include <span>
#include <vector>

/// A GStreamer time as ours. Those beyond thirty years are taken as that: sums of them do not
/// overflow.
tactor::Time to_tactor_time(GstClockTime time);

/// What comes into tactorsink: maps, on video frames or as a stream of their own, and when they are
/// shown. Streaming thread only.
class TactorStream
{
public:
  struct Span
  {
    tactor::Time start{ 0 };
    tactor::Time duration{ 0 };

    tactor::Time end() const
    {
      return start + duration;
    }
  };
  struct Map
  {
    guint rows = 0;
    guint columns = 0;
    std::span<const gfloat> levels; ///< row by row, until the next read
  };

  /// False if these are caps of maps with a grid that cannot be.
  bool set_caps(const GstCaps *caps);

  /// Whether it is a stream of maps rather than video.
  bool is_map() const;

  /// Rows and columns as negotiated; 0 for video.
  guint rows() const;
  guint columns() const;

  /// The buffer's map. False if it has none, or one of the wrong size.
  bool read(GstBuffer *buffer, Map &map);

  /// Running time at which what has this time and duration is shown, and for how long, at the
  /// segment's rate. What has no time begins at `last_end`.
  Span shown(const GstSegment &segment, GstClockTime pts, GstClockTime duration,
             tactor::Time last_end) const;

  /// Whether what has this time and duration is shown at all: a step of frames moves the segment
  /// beyond what has come. What is left of a frame because times are rounded is nothing.
  bool is_shown(const GstSegment &segment, GstClockTime pts, GstClockTime duration) const;

private:
  bool is_map_ = false; ///< application/x-tactile-map
  guint rows_ = 0;
  guint columns_ = 0;
  tactor::Time frame_duration_{ 0 }; ///< 0: unknown
  std::vector<gfloat> levels_;
};
