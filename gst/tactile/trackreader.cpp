// SPDX-License-Identifier: LGPL-2.1-or-later
#include "trackreader.h"

#include "../runningtime.h"
#include "gst/fusion/sound_meta.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

using tactile::TactileMap;

namespace {

/// Most maps of the track on one frame: of a still picture that is shown for long.
constexpr std::size_t kMostMaps = 1000;

GstSegment
segment_of(GstAggregatorPad *pad)
{
  GST_OBJECT_LOCK(pad);
  const GstSegment segment = pad->segment;
  GST_OBJECT_UNLOCK(pad);
  return segment;
}

} // namespace

bool
is_lost(GstBuffer *gap)
{
  return gst_buffer_get_custom_meta(gap, "GstAggregatorMissingDataMeta") != nullptr;
}

std::optional<gint64>
TrackReader::time_of(GstAggregatorPad *pad, GstClockTime pts)
{
  const std::optional<visuotactile::Time> time = running_time::of(segment_of(pad), pts);
  return time ? std::optional<gint64>(time->count()) : std::nullopt;
}

std::optional<gint64>
TrackReader::end_of(GstAggregatorPad *pad, const GstBuffer *buffer, GstClockTime duration,
                    gint64 begin)
{
  const GstSegment segment = segment_of(pad);
  if (!GST_CLOCK_TIME_IS_VALID(duration))
    return std::nullopt;
  if (segment.rate < 0)
    return begin + std::llround(static_cast<double>(duration) / -segment.rate);
  const std::optional<visuotactile::Time> end = running_time::of(
      segment, std::min<GstClockTime>(GST_BUFFER_PTS(buffer) + duration, segment.stop));
  return end ? std::max(end->count(), begin) : begin;
}

bool
TrackReader::set_caps(const GstCaps *caps)
{
  return gst_tactile_map_caps_parse(caps, &rows, &columns, nullptr, nullptr);
}

void
TrackReader::reset()
{
  *this = TrackReader();
}

TactileMap
TrackReader::silence() const
{
  return { static_cast<int>(rows), static_cast<int>(columns) };
}

/* The map in a buffer; silent for a GAP. None, with an error message, if it is not a map. */
std::optional<TactileMap>
TrackReader::read_map(GstAggregatorPad *pad, GstBuffer *buffer) const
{
  TactileMap map = silence();
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP))
    return map;
  g_autofree gfloat *levels = nullptr;
  gsize count = 0;
  if (!has_grid() || !gst_tactile_map_buffer_get_levels(buffer, rows, columns, &levels, &count)) {
    g_autoptr(GstElement) element = gst_pad_get_parent_element(GST_PAD(pad));
    GST_ELEMENT_ERROR(element, STREAM, FORMAT, ("A tactile map has the wrong size."),
                      ("expected %u x %u float32 levels, got %" G_GSIZE_FORMAT " bytes", rows,
                       columns, gst_buffer_get_size(buffer)));
    return std::nullopt;
  }
  std::copy(levels, levels + count, map.levels.begin());
  map.frequency = gst_buffer_get_tactile_frequency(buffer);
  return map;
}

TrackReader::Part
TrackReader::part_at(gint64 time) const
{
  Part part = held && held->covers(time) ? held->part : Part{ .map = silence() };
  part.begin = time;
  return part;
}

/* Reads the track up to `time`. NEED_DATA if that is not known yet. */
GstFlowReturn
TrackReader::advance(GstAggregatorPad *pad, gint64 offset, gint64 time)
{
  for (;;) {
    g_autoptr(GstBuffer) head = gst_aggregator_pad_peek_buffer(pad);
    if (head == nullptr) {
      const bool covers = held && held->end && held->covers(time);
      return covers || gst_aggregator_pad_is_eos(pad) ? GST_FLOW_OK : GST_AGGREGATOR_FLOW_NEED_DATA;
    }
    const std::optional<gint64> running = time_of(pad, GST_BUFFER_PTS(head));
    if (running && *running + offset > time)
      return GST_FLOW_OK;
    std::optional<gint64> end;
    if (running)
      end = end_of(pad, head, GST_BUFFER_DURATION(head), *running);
    if (end)
      *end += offset;
    std::optional<TactileMap> map;
    const bool holds = running && is_lost(head); // the map before it
    if (!holds)
      map = read_map(pad, head);
    gst_aggregator_pad_drop_buffer(pad);
    if (!holds && !map)
      return GST_FLOW_ERROR;
    if (holds && held && held->end && end)
      held->end = end;
    else if (map && running)
      held = { { .begin = *running + offset,
                 .map = std::move(*map),
                 .is_sound = GST_BUFFER_FLAG_IS_SET(head, kSoundMap) },
               end };
  }
}

/* The next time after `time` at which the track may change. */
gint64
TrackReader::next_change(GstAggregatorPad *pad, gint64 offset, gint64 time) const
{
  gint64 next = std::numeric_limits<gint64>::max();
  const auto offer = [&](gint64 change) {
    if (change > time)
      next = std::min(next, change);
  };
  if (held) {
    offer(held->part.begin);
    offer(held->end.value_or(time));
  }
  if (g_autoptr(GstBuffer) head = gst_aggregator_pad_peek_buffer(pad))
    offer(time_of(pad, GST_BUFFER_PTS(head)).value_or(time - offset + 1) + offset);
  return next;
}

GstFlowReturn
TrackReader::add_parts(GstAggregatorPad *pad, gint64 offset, gint64 begin, gint64 end,
                       std::vector<Part> &parts)
{
  while (parts.size() < kMostMaps) {
    const gint64 at = parts.empty() ? begin : next_change(pad, offset, parts.back().begin);
    if (at >= end)
      break;
    if (const GstFlowReturn flow = advance(pad, offset, at); flow != GST_FLOW_OK)
      return flow;
    Part part = part_at(at);
    if (!parts.empty() && part.is_sound) // pieces of sound are whole frames
      break;
    if (parts.size() + 1 == kMostMaps) // and holds until the next frame
      std::ranges::fill(part.map.levels, 0.0F);
    parts.push_back(std::move(part));
    if (parts.back().is_sound)
      break;
  }
  return GST_FLOW_OK;
}
