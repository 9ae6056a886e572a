// SPDX-License-Identifier: LGPL-2.1-or-later
#include "groupshift.h"

#include "../runningtime.h"

#include <algorithm>
#include <utility>

GstSegment
GroupShift::unknown()
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_UNDEFINED);
  return segment;
}

void
GroupShift::start_stream(GstEvent *stream_start)
{
  guint group = GST_GROUP_ID_INVALID;
  gst_event_parse_group_id(stream_start, &group);
  std::lock_guard lock(mutex_);
  if (group_ != GST_GROUP_ID_INVALID && group != group_)
    shift_ += length_;
  group_ = group;
  length_ = 0;
}

void
GroupShift::flush()
{
  std::lock_guard lock(mutex_);
  segment_ = unknown();
  shift_ = length_ = 0;
  any_ = changed_ = false;
}

GstSegment
GroupShift::open(const GstSegment &segment)
{
  {
    std::lock_guard lock(mutex_);
    segment_ = segment;
    any_ = changed_ = false;
    if (segment.format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(segment.stop))
      length_ = static_cast<GstClockTime>(
          std::max(running_time::of(segment, segment.rate > 0 ? segment.stop : segment.start)
                       .value_or(visuotactile::Time(0)),
                   visuotactile::Time(0))
              .count());
  }
  return this->segment();
}

bool
GroupShift::pass(GstBuffer *frame)
{
  std::lock_guard lock(mutex_);
  const GstClockTime time
      = gst_segment_to_running_time(&segment_, GST_FORMAT_TIME, GST_BUFFER_PTS(frame));
  if (segment_.format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(time)) {
    const GstClockTime inside = time - segment_.base;
    const GstClockTime duration
        = GST_BUFFER_DURATION_IS_VALID(frame) ? GST_BUFFER_DURATION(frame) : 0;
    first_ = any_ ? std::min(first_, inside) : inside;
    end_ = any_ ? std::max(end_, inside + duration) : inside + duration;
    length_ = std::max(length_, time + duration);
    any_ = true;
  }
  return std::exchange(changed_, false);
}

GstSegment
GroupShift::segment() const
{
  std::lock_guard lock(mutex_);
  GstSegment shifted = segment_;
  if (shifted.format == GST_FORMAT_TIME)
    shifted.base += shift_;
  return shifted;
}

void
GroupShift::hear(GstEvent *qos)
{
  GstClockTime inside = GST_CLOCK_TIME_NONE; // the offset, the segment's base too, is taken off
  gst_event_parse_qos(qos, nullptr, nullptr, nullptr, &inside);
  const gint64 offset = gst_event_get_running_time_offset(qos);
  if (offset == 0 || !GST_CLOCK_TIME_IS_VALID(inside))
    return;
  std::lock_guard lock(mutex_);
  // Other events concern a frame of the film before, whose time may be clamped to zero.
  const bool of_this = any_ && inside > first_ && inside <= end_;
  const gint64 shift = -offset - static_cast<gint64>(segment_.base);
  if (!of_this || shift < 0 || static_cast<GstClockTime>(shift) == shift_)
    return;
  shift_ = static_cast<GstClockTime>(shift);
  changed_ = true;
}
