// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Finds streams whose times do not advance: GStreamer 1.22 gives each frame of a GIF the time 0,
/// so that sinks show all frames at once. Streaming thread.
class StandingTimes
{
public:
  /// Whether the next buffer has the time of the one before.
  bool stands(GstClockTime pts)
  {
    const bool same = GST_CLOCK_TIME_IS_VALID(pts) && pts == last_;
    same_ = same ? same_ + 1 : 0;
    last_ = pts;
    return same;
  }
  /// Whether so many did that it is no slip; true once in a play.
  bool is_news()
  {
    constexpr guint kSlip = 8;
    return !told_ && same_ >= kSlip && (told_ = true);
  }
  /// The next buffer follows no other.
  void restart()
  {
    same_ = 0;
    last_ = GST_CLOCK_TIME_NONE;
  }

private:
  GstClockTime last_ = GST_CLOCK_TIME_NONE;
  guint same_ = 0;
  bool told_ = false;
};
