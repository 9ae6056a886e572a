// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frametimes.h"

#include <algorithm>

using visuotactile::Time;

FrameTimes::Span
FrameTimes::of(GstBuffer *frame, const GstVideoInfo &info, const GstSegment &segment)
{
  GstClockTime length = GST_BUFFER_DURATION(frame);
  if (!GST_CLOCK_TIME_IS_VALID(length))
    length = info.fps_n > 0 ? gst_util_uint64_scale_int(GST_SECOND, info.fps_d, info.fps_n)
                            : GST_SECOND / 30;
  const Time duration(static_cast<gint64>(std::min<GstClockTime>(length, 3600 * GST_SECOND)));

  // Clamped to thirty years: sums do not overflow.
  constexpr GstClockTime kLatest = 1'000'000'000'000'000'000;
  const GstClockTime pts = GST_BUFFER_PTS(frame);
  Time time(static_cast<gint64>(std::min(pts, kLatest)));
  if (standing_.stands(pts) || !GST_CLOCK_TIME_IS_VALID(pts))
    time = next_;
  else if (segment.format == GST_FORMAT_TIME && segment.rate < 0)
    time = -time;
  // A quarter of a frame: the next one, whose time stamp is swapped, too, is later.
  if (last_ && time <= *last_ && *last_ - time <= kReorder * duration)
    time = *last_ + std::max(duration / 4, Time(1));
  last_ = time;
  next_ = std::min(time, Time(static_cast<gint64>(kLatest))) + duration;
  return { time, duration };
}

void
FrameTimes::reset()
{
  standing_.restart();
  next_ = Time(0);
  last_.reset();
}
