// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/cues/film_start.h"

#include <algorithm>

using visuotactile::Time;

void
FilmStart::add_segment(const GstSegment &segment)
{
  if (!begin_ && segment.format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(segment.time))
    begin_ = Time(static_cast<Time::rep>(segment.time));
}

void
FilmStart::add_first(const GstSegment &segment, GstClockTime timestamp)
{
  guint64 distance = 0;
  const int sign
      = segment.format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(timestamp)
            ? gst_segment_to_stream_time_full(&segment, GST_FORMAT_TIME, timestamp, &distance)
            : 0;
  if (sign == 0)
    return;
  const Time time(sign * static_cast<Time::rep>(distance));
  first_ = first_ ? std::min(*first_, time) : time;
}

Time
FilmStart::stream_time() const
{
  const Time begin = begin_.value_or(Time(0));
  return begin == Time(0) ? begin : first_.value_or(begin);
}

Time
FilmStart::running_time() const
{
  return std::min(stream_time() - begin_.value_or(Time(0)), Time(0));
}
