// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_times.h"

namespace {

/// The frame before, in the streaming thread.
struct Before
{
  GstClockTime time = GST_CLOCK_TIME_NONE; ///< as it came
  GstClockTime end = GST_CLOCK_TIME_NONE;
};

GstClockTime
duration_of(GstPad *pad, const GstBuffer *frame)
{
  if (GST_BUFFER_DURATION_IS_VALID(frame) && GST_BUFFER_DURATION(frame) > 0)
    return GST_BUFFER_DURATION(frame);
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
  gint frames = 0;
  gint seconds = 0;
  return caps != nullptr
                 && gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate",
                                               &frames, &seconds)
                 && frames > 0
             ? gst_util_uint64_scale(GST_SECOND, static_cast<guint64>(seconds),
                                     static_cast<guint64>(frames))
             : GST_CLOCK_TIME_NONE;
}

GstPadProbeReturn
on_data(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
  Before &before = *static_cast<Before *>(data);
  if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) == 0) {
    if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_SEGMENT)
      before = {};
    return GST_PAD_PROBE_OK;
  }
  GstBuffer *frame = GST_PAD_PROBE_INFO_BUFFER(info);
  const GstClockTime time = GST_BUFFER_PTS(frame);
  const bool stands = !GST_CLOCK_TIME_IS_VALID(time) || time == before.time;
  if (stands && GST_CLOCK_TIME_IS_VALID(before.end)) {
    frame = gst_buffer_make_writable(frame);
    GST_BUFFER_PTS(frame) = before.end;
    GST_PAD_PROBE_INFO_DATA(info) = frame;
  }
  const GstClockTime duration = duration_of(pad, frame);
  before.time = GST_CLOCK_TIME_IS_VALID(time) ? time : before.time;
  before.end = GST_BUFFER_PTS_IS_VALID(frame) && GST_CLOCK_TIME_IS_VALID(duration)
                   ? GST_BUFFER_PTS(frame) + duration
                   : GST_CLOCK_TIME_NONE;
  return GST_PAD_PROBE_OK;
}

} // namespace

void
let_times_advance(GstPad *pad)
{
  gst_pad_add_probe(
      pad,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM),
      on_data, new Before, +[](gpointer before) { delete static_cast<Before *>(before); });
}
