// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorstream.h"

#include "../runningtime.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cmath>

using tactor::Time;

/// The coarsest resolution of timestamps in a container (Matroska).
static constexpr GstClockTime kResolution = GST_MSECOND;

/// Thirty years: sums do not overflow.
static constexpr Time kLatest{ 1'000'000'000'000'000'000 };

Time
to_tactor_time(GstClockTime time)
{
  return Time(static_cast<gint64>(std::min(time, static_cast<GstClockTime>(kLatest.count()))));
}

bool
TactorStream::set_caps(const GstCaps *caps)
{
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  gint fps_n = 0;
  gint fps_d = 1;
  TactorStream stream;

  stream.is_map_ = gst_structure_has_name(structure, GST_TACTILE_MAP_MEDIA_TYPE);
  if (!stream.is_map_)
    gst_structure_get_fraction(structure, "framerate", &fps_n, &fps_d);
  else if (!gst_tactile_map_caps_parse(caps, &stream.rows_, &stream.columns_, &fps_n, &fps_d))
    return false;
  if (fps_n > 0)
    stream.frame_duration_ = to_tactor_time(gst_util_uint64_scale_int(GST_SECOND, fps_d, fps_n));
  *this = std::move(stream);
  return true;
}

bool
TactorStream::is_map() const
{
  return is_map_;
}

guint
TactorStream::rows() const
{
  return rows_;
}

guint
TactorStream::columns() const
{
  return columns_;
}

bool
TactorStream::read(GstBuffer *buffer, Map &map)
{
  if (is_map_) {
    g_autofree gfloat *levels = nullptr;
    gsize count = 0;
    if (!gst_tactile_map_buffer_get_levels(buffer, rows_, columns_, &levels, &count))
      return false;
    levels_.assign(levels, levels + count);
    map = { .rows = rows_, .columns = columns_, .levels = levels_ };
    return true;
  }
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  if (!meta)
    return false;
  levels_.assign(meta->levels, meta->levels + static_cast<gsize>(meta->rows) * meta->columns);
  map = { .rows = meta->rows, .columns = meta->columns, .levels = levels_ };
  return true;
}

TactorStream::Span
TactorStream::shown(const GstSegment &segment, GstClockTime pts, GstClockTime duration,
                    Time last_end, std::optional<Time> now) const
{
  const double rate = segment.rate == 0 ? 1.0 : std::abs(segment.rate);
  Time length = GST_CLOCK_TIME_IS_VALID(duration) ? to_tactor_time(duration) : frame_duration_;
  GstClockTime position = segment.format == GST_FORMAT_TIME ? pts : GST_CLOCK_TIME_NONE;
  if (GST_CLOCK_TIME_IS_VALID(position)) {
    if (segment.rate < 0)
      position += static_cast<GstClockTime>(length.count());
    if (GST_CLOCK_TIME_IS_VALID(segment.stop))
      position = std::min<GstClockTime>(position, segment.stop);
    position = std::max<GstClockTime>(position, segment.start);
  } else if (length == Time(0) && !now) {
    length = kUnknown;
  }
  const Time start
      = running_time::of(segment, position).value_or(std::max(last_end, now.value_or(last_end)));
  return { .start = std::clamp(start, -kLatest, kLatest),
           .duration = Time(
               static_cast<gint64>(std::min(static_cast<double>(length.count()) / rate, 1e15))) };
}

bool
TactorStream::is_untimed(const GstSegment &segment, GstClockTime pts, GstClockTime duration) const
{
  const bool has_time = segment.format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(pts);
  return !has_time && !GST_CLOCK_TIME_IS_VALID(duration) && frame_duration_ == Time(0);
}

bool
TactorStream::is_shown(const GstSegment &segment, GstClockTime pts, GstClockTime duration) const
{
  if (segment.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(pts))
    return true;
  if (!GST_CLOCK_TIME_IS_VALID(duration))
    duration = static_cast<GstClockTime>(frame_duration_.count());
  const GstClockTime end = pts + duration;
  guint64 first = 0;
  guint64 last = 0;
  if (!gst_segment_clip(&segment, GST_FORMAT_TIME, pts, end, &first, &last))
    return false;
  return (first == pts && last == end) || last - first > kResolution;
}
