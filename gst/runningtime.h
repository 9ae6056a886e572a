// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/gst.h>

#include <algorithm>
#include <optional>

namespace running_time {

/// Running time of a position, negative where the offset of a pad puts it before the pipeline's
/// zero. None outside of the segment, of GST_CLOCK_TIME_NONE, and in a segment of another format.
inline std::optional<visuotactile::Time>
of(const GstSegment &segment, GstClockTime position)
{
  guint64 time = 0;
  // Unlike gst_segment_to_running_time() it also takes what is outside of the segment.
  if (segment.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(position)
      || position < segment.start
      || (GST_CLOCK_TIME_IS_VALID(segment.stop) && position > segment.stop))
    return std::nullopt;
  const gint sign = gst_segment_to_running_time_full(&segment, GST_FORMAT_TIME, position, &time);
  if (sign == 0 || time > static_cast<guint64>(G_MAXINT64))
    return std::nullopt;
  return visuotactile::Time(sign * static_cast<gint64>(time));
}

/// Position of a running time; GST_CLOCK_TIME_NONE if that is before position 0.
inline GstClockTime
to_position(const GstSegment &segment, visuotactile::Time time)
{
  // GStreamer takes no running time before zero, but a segment whose base is later.
  const visuotactile::Time zero(0);
  GstSegment later = segment;
  later.base += static_cast<guint64>(std::max(-time, zero).count());
  guint64 position = 0;
  const gint sign = gst_segment_position_from_running_time_full(
      &later, GST_FORMAT_TIME, static_cast<guint64>(std::max(time, zero).count()), &position);
  return sign > 0 ? position : GST_CLOCK_TIME_NONE;
}

} // namespace running_time
