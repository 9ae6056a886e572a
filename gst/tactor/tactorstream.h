// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/gst.h>

#include <optional>
#include <span>
#include <vector>

/// Converts a time. Clamped to thirty years, so that sums do not overflow.
tactor::Time to_tactor_time(GstClockTime time);

/// The input of tactorsink and tactilesynth: maps, on video frames or as a stream of their own, and
/// their running times. Streaming thread only.
class TactorStream
{
public:
  /// How long a map holds after the end of its frame if no other follows.
  static constexpr tactor::Time kHold = std::chrono::seconds(1);
  /// Length of a frame of which nothing is known.
  static constexpr tactor::Time kUnknown{ 1'000'000'000 / 30 };

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
    std::span<const gfloat> levels; ///< row by row, valid until the next read()
  };

  /// False if the caps are of maps and their grid is invalid.
  bool set_caps(const GstCaps *caps);

  /// Whether the stream has maps rather than video.
  bool is_map() const;

  /// Rows and columns as negotiated; 0 for video.
  guint rows() const;
  guint columns() const;

  /// Reads the buffer's map. False if it has none, or one of the wrong size.
  bool read(GstBuffer *buffer, Map &map);

  /// Running time and duration of a buffer or gap at the segment's rate. Without a timestamp it
  /// begins at `last_end`, or `now` if that is later: sinks show such frames as they come. `now` is
  /// the running time, where the clock paces the stream; without it a frame of unknown duration is
  /// kUnknown long.
  Span shown(const GstSegment &segment, GstClockTime pts, GstClockTime duration,
             tactor::Time last_end, std::optional<tactor::Time> now = std::nullopt) const;

  /// Whether timestamp, duration and frame rate are missing, so that the time of a buffer is
  /// unknown.
  bool is_untimed(const GstSegment &segment, GstClockTime pts, GstClockTime duration) const;

  /// Whether any of a buffer or gap is shown: a step moves the segment beyond frames that have
  /// come. Rests of less than the rounding of timestamps do not count.
  bool is_shown(const GstSegment &segment, GstClockTime pts, GstClockTime duration) const;

private:
  bool is_map_ = false; ///< application/x-tactile-map
  guint rows_ = 0;
  guint columns_ = 0;
  tactor::Time frame_duration_{ 0 }; ///< 0: unknown
  std::vector<gfloat> levels_;
};
