// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorplay.h"

#include <algorithm>
#include <optional>
#include <utility>

using tactor::Time;

TactorPlay::TactorPlay(GstBaseSink *sink, TactorSession &session)
    : sink_(sink), session_(session), scheduler_(session.scheduler()), planning_(GST_ELEMENT(sink))
{
}

void
TactorPlay::begin()
{
  plans_ = false;
  GST_OBJECT_LOCK(sink_);
  limited_ = {};
  GST_OBJECT_UNLOCK(sink_);
}

GstFlowReturn
TactorPlay::wait_until_open()
{
  if (plans_)
    return GST_FLOW_OK;
  const GstFlowReturn ret = session_.wait_until_open();
  if (ret != GST_FLOW_OK)
    return ret;
  OpenTactors &tactors = session_.tactors();
  planning_.start(tactors.planner, tactors.count, tactors.layout, std::move(tactors.motors),
                  tactors.account);
  plans_ = true;
  return GST_FLOW_OK;
}

bool
TactorPlay::set_caps(const GstCaps *caps)
{
  return planning_.set_caps(caps);
}

GstFlowReturn
TactorPlay::play_map(GstBuffer *buffer, tactor::PlannerSettings settings)
{
  session_.tell_short_lead();
  if (const std::optional<Time> starved = scheduler_.take_starved())
    planning_.silenced(*starved);
  const GstSegment now = segment();
  TactorStream::Span shown = planning_.shown(buffer, now, paced_time());
  // The base class drops frames that a step skips, but not the one at its end.
  const bool is_timed = now.format == GST_FORMAT_TIME && GST_BUFFER_PTS_IS_VALID(buffer);
  if ((is_timed && session_.is_missed(shown))
      || !planning_.is_shown(GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer), now))
    return GST_FLOW_OK;
  settings.transport_latency = std::min(scheduler_.transport_latency(), session_.tactors().latency);
  const std::optional<TactorPlanning::Plan> plan
      = planning_.plan_map(buffer, shown, std::move(settings));
  if (!plan)
    return GST_FLOW_ERROR;
  if (sink_->flushing) // since the lock was released to post a message
    return GST_FLOW_FLUSHING;
  push(*plan);
  return GST_FLOW_OK;
}

void
TactorPlay::play_gap(GstClockTime pts, GstClockTime duration)
{
  const GstSegment now = segment();
  if (planning_.is_shown(pts, duration, now))
    push(planning_.plan_gap(pts, duration, now));
}

/// The base class would end its wait render-delay early, and wait on during a pause.
GstFlowReturn
TactorPlay::drain()
{
  const TactorPlanning::Plan rest = planning_.plan_rest();
  push(rest);
  const GstClockTime end = static_cast<GstClockTime>(std::max<gint64>(rest.end.count(), 0));
  const GstFlowReturn ret
      = gst_base_sink_wait(sink_, end + gst_base_sink_get_render_delay(sink_), nullptr);
  if (ret != GST_FLOW_OK)
    return ret;

  // As in the base class, the lock is released meanwhile: pause, play and flush need it.
  const guint64 interruptions = scheduler_.interruptions();
  GST_BASE_SINK_PREROLL_UNLOCK(sink_);
  scheduler_.drain(interruptions);
  session_.tell_short_lead();
  GST_BASE_SINK_PREROLL_LOCK(sink_);
  if (sink_->flushing)
    return GST_FLOW_FLUSHING;
  scheduler_.flush();
  return GST_FLOW_OK;
}

void
TactorPlay::flush_started()
{
  flushed_at_ = scheduler_.flush();
}

void
TactorPlay::flush_stopped(bool resets_time)
{
  if (plans_) // else nothing was planned
    planning_.flushed(flushed_at_, resets_time);
}

/// Running time does not count these frames. In a pause, running time is the element's start time,
/// not the clock's.
void
TactorPlay::stepped()
{
  if (!plans_)
    return;
  Time stopped = scheduler_.flush();
  const GstClockTime start = gst_element_get_start_time(GST_ELEMENT(sink_));
  if (GST_CLOCK_TIME_IS_VALID(start))
    stopped = Time(static_cast<GstClockTimeDiff>(start)
                   - static_cast<GstClockTimeDiff>(gst_base_sink_get_latency(sink_))
                   - gst_base_sink_get_ts_offset(sink_));
  planning_.flushed(stopped, false);
}

tactor::LimitCounters
TactorPlay::limited() const
{
  GST_OBJECT_LOCK(sink_);
  const tactor::LimitCounters limited = limited_;
  GST_OBJECT_UNLOCK(sink_);
  return limited;
}

GstSegment
TactorPlay::segment() const
{
  GST_OBJECT_LOCK(sink_);
  const GstSegment segment = sink_->segment;
  GST_OBJECT_UNLOCK(sink_);
  return segment;
}

/// The running time, if the clock paces the stream.
std::optional<Time>
TactorPlay::paced_time() const
{
  return gst_base_sink_get_sync(sink_) ? session_.read_timing().now() : std::nullopt;
}

/// Hands a plan to the scheduler.
void
TactorPlay::push(const TactorPlanning::Plan &plan)
{
  GST_OBJECT_LOCK(sink_);
  limited_ = planning_.limited();
  GST_OBJECT_UNLOCK(sink_);
  scheduler_.push(plan.commands, plan.end + TactorStream::kHold,
                  session_.read_timing().now().value_or(Time::min()));
}
