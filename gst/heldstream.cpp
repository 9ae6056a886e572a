// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heldstream.h"

#include <utility>

HeldStream::HeldStream(Ways ways) : ways_(std::move(ways))
{
}

HeldStream::~HeldStream()
{
  clear();
}

static GstClockTime
length_of(GstMiniObject *held)
{
  if (!GST_IS_BUFFER(held) || !GST_BUFFER_DURATION_IS_VALID(held))
    return 0;
  return GST_BUFFER_DURATION(GST_BUFFER_CAST(held));
}

GstFlowReturn
HeldStream::pass_first()
{
  GstMiniObject *first = held_.front();
  held_.pop_front();
  length_ -= length_of(first);
  if (GST_IS_BUFFER(first))
    return ways_.pass(GST_BUFFER_CAST(first));
  ways_.pass_event(GST_EVENT_CAST(first));
  return GST_FLOW_OK;
}

GstFlowReturn
HeldStream::hold(GstBuffer *buffer, GstClockTime time)
{
  const bool holds
      = time > 0 && length_of(GST_MINI_OBJECT_CAST(buffer)) > 0 && held_.size() < kMost;
  held_.push_back(GST_MINI_OBJECT_CAST(buffer));
  length_ += length_of(held_.back());
  GstFlowReturn flow = GST_FLOW_OK;
  while (flow == GST_FLOW_OK && !held_.empty()
         && (!holds || length_ >= time + length_of(held_.front())))
    flow = pass_first();
  return flow;
}

gboolean
HeldStream::hold(GstEvent *event)
{
  if (held_.empty())
    return ways_.pass_event(event);
  while (held_.size() >= kMost)
    pass_first();
  held_.push_back(GST_MINI_OBJECT_CAST(event));
  return TRUE;
}

void
HeldStream::look_through(const std::function<bool(GstBuffer *)> &enough) const
{
  for (GstMiniObject *held : held_)
    if (GST_IS_BUFFER(held) && enough(GST_BUFFER_CAST(held)))
      return;
}

GstFlowReturn
HeldStream::drain()
{
  GstFlowReturn flow = GST_FLOW_OK;
  while (!held_.empty()) {
    const GstFlowReturn passed = pass_first();
    flow = flow == GST_FLOW_OK ? passed : flow;
  }
  return flow;
}

static bool
outlives_a_flush(GstMiniObject *held)
{
  return GST_IS_EVENT(held)
         && (gst_event_type_get_flags(GST_EVENT_TYPE(held)) & GST_EVENT_TYPE_STICKY)
         && GST_EVENT_TYPE(held) != GST_EVENT_SEGMENT && GST_EVENT_TYPE(held) != GST_EVENT_EOS;
}

void
HeldStream::flush()
{
  for (GstMiniObject *held : std::exchange(held_, {}))
    if (outlives_a_flush(held))
      ways_.pass_event(GST_EVENT_CAST(held));
    else
      gst_mini_object_unref(held);
  length_ = 0;
}

void
HeldStream::clear()
{
  for (GstMiniObject *held : held_)
    gst_mini_object_unref(held);
  held_.clear();
  length_ = 0;
}
