// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactorsink
 * @title: tactorsink
 * @short_description: plays tactile maps on vibration motors, early and on the clock
 *
 * tactorsink takes either video frames that carry a #GstTactileMeta (as `saliencytactile` adds
 * them) or a stream of tactile maps (`application/x-tactile-map`, as `tactileextractor` makes it)
 * and drives one vibration motor (tactor) per cell.
 *
 * A coin motor needs up to 180 ms to reach 90 % of its level, so each command is issued that much
 * before its frame is shown. The element asks for its data #GstTactorSink:max-lead early by means
 * of render-delay, which delays every other sink of the pipeline accordingly; the data has to be
 * there by then, so put a queue with `max-size-bytes=0 max-size-buffers=0 max-size-time=400000000`
 * before each sink (a default queue holds three raw 1080p frames, which is too little) or do
 * without raw frames in the tactile branch, as in the second line below.
 *
 * Every way out of PLAYING leaves all motors at zero: pause, flush, end of stream, error, and an
 * upstream that stops delivering.
 *
 * Motors and skin are spared: #GstTactorSink:max-on-time, #GstTactorSink:max-duty and
 * #GstTactorSink:max-active end cues, #GstTactorSink:ramp-in softens the first vibration after
 * start, seek and pause. 0 switches each of them off.
 *
 * With #GstTactorSink:calibration each tactor has its own motor, as `tactor-calibrate` measured it:
 * its rise times and its latency make the lead, its start and hold volts decide what is sent as 0
 * in place of #GstTactorSink:voltage-min, and levels become volts so that what is felt is linear in
 * the level and equally strong on all tactors.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! \
 *     tactorsink trace-location=commands.csv
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! \
 *     videoconvert ! autovideosink \
 *     x.tactile ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! tactorsink
 * ]|
 *
 * A board takes up to five seconds to answer. It is opened in the background from READY to PAUSED
 * on, and the stream waits for it; what is wrong with it is an error message.
 *
 * As a #GstURIHandler it plays on `tactor://SERIAL`, the board with that serial number or bus path.
 *
 * ## Messages
 * - `tactor-lead-short`: a command could not be issued as early as its motor needs; fields `lead`
 *   and `late` (#guint64, ns). At most one in five seconds.
 * - `tactor-device-refused`: the board is back, but cannot be used: reason
 * - `tactor-device-lost`, `tactor-device-found`: the board went away, came back; with them a
 *   warning and an info message for people. The film plays on meanwhile.
 * - a warning, while the pipeline is on its way to PAUSED: it waits for ever, because one thread
 *   feeds this and another sink without a queue between them.
 * - `tactor-stats`: the contents of #GstTactorSink:actuation-stats at the end of the stream.
 *
 * Since: 0.1
 */
#include "gsttactorsink.h"

#include "queuewatch.h"
#include "tactormessages.h"
#include "tactoropening.h"
#include "tactorplanning.h"
#include "tactorscheduler.h"
#include "tactorsettings.h"
#include "tactorurihandler.h"

#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

namespace {

/// Data is asked for this much before the earliest command can be due: the time that planning and a
/// wake-up take.
constexpr Time kWakeMargin = std::chrono::milliseconds(10);

/// A map is held at most this long after the end of its frame if no other follows.
constexpr Time kHold = std::chrono::seconds(1);

/// At most one message about short leads in this time.
constexpr Time kLeadShortInterval = std::chrono::seconds(5);

} // namespace

struct GstTactorSinkPrivate final : TactorSchedulerHost
{
  explicit GstTactorSinkPrivate(GstTactorSink *sink)
      : element(GST_ELEMENT(sink)), planning(element), scheduler(*this), queue_watch(element)
  {
  }

  Timing timing() override;
  std::optional<Time> running_time();
  void open_failed(const tactor::DriverError &error) override;
  void device_failed(const tactor::DriverError &error) override;
  void lead_short(Time lead, Time late) override;
  void scheduled(tactor::Scheduling scheduling, const std::string &text) override;
  void device_event(const tactor::DriverEvent &event);

  GstElement *element;           ///< not owned: this is its private part
  TactorSettings settings;       ///< guarded by the object lock
  tactor::LimitCounters limited; ///< guarded by the object lock

  TactorOpening
      opening; ///< the scheduler's thread's until the board is open, then the streaming one's
  bool is_open = false;               ///< what was opened is planned for; as planning
  TactorPlanning planning;            ///< streaming thread only, or while it is stopped
  std::optional<GstClockTime> opened; ///< clock time, in a live play until a frame was shown since
  Time flushed_at{ 0 };               ///< running time of the last flush
  std::atomic<bool> ended{ false };   ///< the last map has come

  std::optional<Time> last_lead_short; ///< scheduler's thread only

  TactorScheduler scheduler; ///< after what its thread uses, which ends before
  QueueWatch queue_watch;    ///< changes of state only
};

struct _GstTactorSink
{
  GstBaseSink parent;
  GstTactorSinkPrivate *priv;
};

#define gst_tactor_sink_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactorSink, gst_tactor_sink, GST_TYPE_BASE_SINK,
                        G_IMPLEMENT_INTERFACE(GST_TYPE_URI_HANDLER, tactor_uri_handler_init);
                        GST_DEBUG_CATEGORY_INIT(tactor_sink_debug, "tactorsink", 0, "tactor sink"));
GST_ELEMENT_REGISTER_DEFINE(tactorsink, "tactorsink", GST_RANK_NONE, GST_TYPE_TACTOR_SINK);

static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                              GST_STATIC_CAPS("video/x-raw(ANY); " GST_TACTILE_MAP_CAPS));

/* ---- host of the scheduler ---- */

TactorSchedulerHost::Timing
GstTactorSinkPrivate::timing()
{
  GstBaseSink *sink = GST_BASE_SINK(element);
  Timing timing;
  timing.clock = gst_element_get_clock(element);
  timing.offset = static_cast<GstClockTimeDiff>(gst_element_get_base_time(element))
                  + static_cast<GstClockTimeDiff>(gst_base_sink_get_latency(sink))
                  + gst_base_sink_get_ts_offset(sink);
  return timing;
}

/// None without a clock.
std::optional<Time>
GstTactorSinkPrivate::running_time()
{
  const Timing now = timing();
  if (!now.clock)
    return std::nullopt;
  const Time time(GST_CLOCK_DIFF(now.offset, static_cast<gint64>(gst_clock_get_time(now.clock))));
  gst_object_unref(now.clock);
  return time;
}

/// On any thread of the driver's.
void
GstTactorSinkPrivate::device_event(const tactor::DriverEvent &event)
{
  using Kind = tactor::DriverEvent::Kind;
  if (event.kind == Kind::lost || event.kind == Kind::returned)
    scheduler.set_board_away(event.kind == Kind::lost);
  tactor_post_device_event(element, event);
}

void
GstTactorSinkPrivate::open_failed(const tactor::DriverError &error)
{
  tactor_post_open_error(element, error);
}

void
GstTactorSinkPrivate::device_failed(const tactor::DriverError &error)
{
  GST_ELEMENT_ERROR(element, RESOURCE, WRITE, ("%s", error.text.c_str()), (nullptr));
}

void
GstTactorSinkPrivate::lead_short(Time lead, Time late)
{
  GST_DEBUG_OBJECT(element,
                   "command with a lead of %" GST_STIME_FORMAT " is late by %" GST_STIME_FORMAT,
                   GST_STIME_ARGS(lead.count()), GST_STIME_ARGS(late.count()));
  const Time now(static_cast<gint64>(gst_util_get_timestamp()));
  if (last_lead_short && now - *last_lead_short < kLeadShortInterval)
    return;
  last_lead_short = now;
  tactor_post_lead_short(element, lead, late);
}

void
GstTactorSinkPrivate::scheduled(tactor::Scheduling scheduling, const std::string &text)
{
  GST_INFO_OBJECT(element, "the thread that issues commands: %s (%s)",
                  tactor::to_string(scheduling).data(), text.c_str());
}

static GstStructure *
gst_tactor_sink_stats(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;
  GST_OBJECT_LOCK(self);
  const tactor::LimitCounters limited = priv->limited;
  GST_OBJECT_UNLOCK(self);
  return tactor_stats_new(priv->scheduler.counters(), priv->scheduler.driver_status(), limited,
                          priv->scheduler.scheduling());
}

/* ---- planning (streaming thread) ---- */

static GstSegment
gst_tactor_sink_segment(GstTactorSink *self)
{
  GST_OBJECT_LOCK(self);
  const GstSegment segment = GST_BASE_SINK(self)->segment;
  GST_OBJECT_UNLOCK(self);
  return segment;
}

/// Hands over what was planned.
static void
gst_tactor_sink_push(GstTactorSink *self, const TactorPlanning::Plan &plan)
{
  GstTactorSinkPrivate *priv = self->priv;
  GST_OBJECT_LOCK(self);
  priv->limited = priv->planning.limited();
  GST_OBJECT_UNLOCK(self);
  priv->scheduler.push(plan.commands, plan.end + kHold, priv->running_time().value_or(Time::min()));
}

/// Lets controlled properties have their values for the frame at hand.
static void
gst_tactor_sink_sync_values(GstTactorSink *self, GstClockTime pts)
{
  const GstSegment segment = gst_tactor_sink_segment(self);
  if (segment.format != GST_FORMAT_TIME)
    return;
  const GstClockTime time = gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, pts);
  if (GST_CLOCK_TIME_IS_VALID(time))
    gst_object_sync_values(GST_OBJECT(self), time);
}

/// Whether a frame of a live play was to be felt while the board was being opened, and is past. A
/// board that was open before the play began has missed nothing.
static bool
gst_tactor_sink_is_past(GstTactorSink *self, GstBuffer *buffer, const GstSegment &segment)
{
  GstTactorSinkPrivate *priv = self->priv;
  if (!priv->opened || segment.format != GST_FORMAT_TIME)
    return false;
  TactorSchedulerHost::Timing timing = priv->timing();
  g_clear_object(&timing.clock);
  const GstClockTimeDiff opened = GST_CLOCK_DIFF(timing.offset, static_cast<gint64>(*priv->opened));
  const GstClockTime shown
      = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  const auto lead
      = static_cast<GstClockTimeDiff>(gst_base_sink_get_render_delay(GST_BASE_SINK(self)));
  if (opened > 0 && GST_CLOCK_TIME_IS_VALID(shown)
      && static_cast<GstClockTimeDiff>(shown) < opened + lead)
    return true;
  priv->opened.reset();
  return false;
}

/// Plans what a buffer asks for and hands it to the scheduler.
static GstFlowReturn
gst_tactor_sink_play_map(GstTactorSink *self, GstBuffer *buffer)
{
  GstTactorSinkPrivate *priv = self->priv;

  if (const std::optional<Time> starved = priv->scheduler.take_starved())
    priv->planning.silenced(*starved);
  const GstSegment segment = gst_tactor_sink_segment(self);
  if (gst_tactor_sink_is_past(self, buffer, segment))
    return GST_FLOW_OK;
  // The base class drops what a step has gone past, but for the frame at its end.
  if (!priv->planning.is_shown(GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer), segment))
    return GST_FLOW_OK;
  GST_OBJECT_LOCK(self);
  tactor::PlannerSettings settings = priv->settings.planner;
  GST_OBJECT_UNLOCK(self);
  const std::optional<TactorPlanning::Plan> plan
      = priv->planning.plan_map(buffer, segment, std::move(settings));
  if (!plan)
    return GST_FLOW_ERROR;
  gst_tactor_sink_push(self, *plan);
  return GST_FLOW_OK;
}

/// Whether time goes on upstream whatever this element does.
static bool
is_live(GstBaseSink *sink)
{
  GstQuery *query = gst_query_new_latency();
  gboolean live = FALSE;
  if (gst_pad_peer_query(GST_BASE_SINK_PAD(sink), query))
    gst_query_parse_latency(query, &live, nullptr, nullptr);
  gst_query_unref(query);
  return live;
}

/// Waits until the board is open, which is begun on the way to PAUSED, and plans for it from then
/// on. Called with the preroll lock held, which is given up meanwhile, as the base class does:
/// pause, flush and stop need it.
static GstFlowReturn
gst_tactor_sink_wait_until_open(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;
  GstBaseSink *sink = GST_BASE_SINK(self);

  if (priv->is_open)
    return GST_FLOW_OK;
  using Outcome = TactorScheduler::Outcome;
  for (Outcome outcome = Outcome::interrupted; outcome != Outcome::open;) {
    const guint64 interruptions = priv->scheduler.interruptions();
    GST_BASE_SINK_PREROLL_UNLOCK(sink);
    outcome = priv->scheduler.wait_until_open(interruptions);
    GST_BASE_SINK_PREROLL_LOCK(sink);
    if (sink->flushing || outcome == Outcome::stopped)
      return GST_FLOW_FLUSHING;
    if (outcome == Outcome::failed) { // the reason was told
      gst_element_abort_state(GST_ELEMENT(self));
      return GST_FLOW_ERROR;
    }
  }
  TactorOpening &opening = priv->opening;
  priv->opened.reset();
  if (GstClock *clock = is_live(sink) ? gst_element_get_clock(GST_ELEMENT(self)) : nullptr) {
    priv->opened = gst_clock_get_time(clock);
    gst_object_unref(clock);
  }
  priv->planning.start(opening.planner, opening.tactors, std::move(opening.motors));
  priv->is_open = true;
  return GST_FLOW_OK;
}

static GstFlowReturn
gst_tactor_sink_render(GstBaseSink *sink, GstBuffer *buffer)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);

  if (const GstFlowReturn ret = gst_tactor_sink_wait_until_open(self); ret != GST_FLOW_OK)
    return ret;
  gst_tactor_sink_sync_values(self, GST_BUFFER_PTS(buffer));
  if (self->priv->scheduler.failed())
    return GST_FLOW_ERROR; // said when it happened
  return gst_tactor_sink_play_map(self, buffer);
}

/// Waits until the last map has been shown and the motors stand, which is later than the base class
/// does: its wait ends render-delay early, and goes on while the play is paused.
static GstFlowReturn
gst_tactor_sink_drain(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;
  GstBaseSink *sink = GST_BASE_SINK(self);

  const TactorPlanning::Plan rest = priv->planning.plan_rest();
  gst_tactor_sink_push(self, rest);
  const GstClockTime end = static_cast<GstClockTime>(std::max<gint64>(rest.end.count(), 0));
  const GstFlowReturn ret
      = gst_base_sink_wait(sink, end + gst_base_sink_get_render_delay(sink), nullptr);
  if (ret != GST_FLOW_OK)
    return ret;

  // As in the base class, the lock is given up while waiting: pause, play and flush need it.
  const guint64 interruptions = priv->scheduler.interruptions();
  GST_BASE_SINK_PREROLL_UNLOCK(sink);
  priv->scheduler.drain(interruptions);
  GST_BASE_SINK_PREROLL_LOCK(sink);
  if (sink->flushing)
    return GST_FLOW_FLUSHING;
  priv->scheduler.flush();
  return GST_FLOW_OK;
}

static GstFlowReturn
gst_tactor_sink_wait_event(GstBaseSink *sink, GstEvent *event)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);

  GstFlowReturn ret = GST_BASE_SINK_CLASS(parent_class)->wait_event(sink, event);
  if (ret != GST_FLOW_OK)
    return ret;

  if (GST_EVENT_TYPE(event) == GST_EVENT_GAP) {
    GstClockTime pts;
    GstClockTime length;
    gst_event_parse_gap(event, &pts, &length);
    const GstSegment segment = gst_tactor_sink_segment(self);
    if (self->priv->planning.is_shown(pts, length, segment))
      gst_tactor_sink_push(self, self->priv->planning.plan_gap(pts, length, segment));
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_EOS) {
    self->priv->ended = true;
    ret = gst_tactor_sink_drain(self);
    if (ret == GST_FLOW_OK)
      tactor_post_stats(GST_ELEMENT(self), gst_tactor_sink_stats(self));
  }
  return ret;
}

static gboolean
gst_tactor_sink_unlock(GstBaseSink *sink)
{
  GST_TACTOR_SINK(sink)->priv->scheduler.interrupt(true);
  return TRUE;
}

static gboolean
gst_tactor_sink_unlock_stop(GstBaseSink *sink)
{
  GST_TACTOR_SINK(sink)->priv->scheduler.interrupt(false);
  return TRUE;
}

static gboolean
gst_tactor_sink_event(GstBaseSink *sink, GstEvent *event)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;
  const GstEventType type = GST_EVENT_TYPE(event);

  // For these the base class has taken the preroll lock.
  if ((gst_event_type_get_flags(type) & GST_EVENT_TYPE_SERIALIZED) && type != GST_EVENT_FLUSH_STOP
      && gst_tactor_sink_wait_until_open(self) != GST_FLOW_OK) {
    gst_event_unref(event);
    return FALSE;
  }

  gboolean resets_time = FALSE;
  if (type == GST_EVENT_FLUSH_STOP)
    gst_event_parse_flush_stop(event, &resets_time);

  const gboolean handled = GST_BASE_SINK_CLASS(parent_class)->event(sink, event);
  if (type == GST_EVENT_FLUSH_STOP || type == GST_EVENT_STREAM_START)
    priv->ended = false;
  // Afterwards, since only then the streaming thread has left render().
  if (type == GST_EVENT_FLUSH_START)
    priv->flushed_at = priv->scheduler.flush();
  else if (type == GST_EVENT_FLUSH_STOP && priv->is_open) // else nothing was planned
    priv->planning.flushed(priv->flushed_at, resets_time);
  return handled;
}

/// The base class says that a step is over on the streaming thread, before what comes next. What is
/// on its way belongs to frames that were gone past: running time stood still for them, since the
/// play was paused if it was. The clock did not.
static void
gst_tactor_sink_stepped(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;
  GstBaseSink *sink = GST_BASE_SINK(self);
  if (!priv->is_open)
    return;
  Time stopped = priv->scheduler.flush();
  const GstClockTime start = gst_element_get_start_time(GST_ELEMENT(self));
  if (GST_CLOCK_TIME_IS_VALID(start))
    stopped = Time(static_cast<GstClockTimeDiff>(start)
                   - static_cast<GstClockTimeDiff>(gst_base_sink_get_latency(sink))
                   - gst_base_sink_get_ts_offset(sink));
  priv->planning.flushed(stopped, false);
}

static gboolean
gst_tactor_sink_post_message(GstElement *element, GstMessage *message)
{
  gboolean flush = FALSE;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_DONE)
    gst_message_parse_step_done(message, nullptr, nullptr, nullptr, &flush, nullptr, nullptr,
                                nullptr);
  if (flush)
    gst_tactor_sink_stepped(GST_TACTOR_SINK(element));
  return GST_ELEMENT_CLASS(parent_class)->post_message(element, message);
}

static gboolean
gst_tactor_sink_set_caps(GstBaseSink *sink, GstCaps *caps)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  if (self->priv->planning.set_caps(caps))
    return TRUE;
  GST_ERROR_OBJECT(self, "expected rows and columns from 1 to %d, got %" GST_PTR_FORMAT,
                   GST_TACTILE_MAX_SIDE, caps);
  return FALSE;
}

/// A queue before this sink has to hold what is asked for early, and upstream may keep its strides.
static gboolean
gst_tactor_sink_propose_allocation(GstBaseSink *sink, GstQuery *query)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstCaps *caps;
  GstVideoInfo info;

  gst_query_parse_allocation(query, &caps, nullptr);
  if (!caps)
    return FALSE;
  gst_query_add_allocation_meta(query, GST_TACTILE_META_API_TYPE, nullptr);
  if (gst_structure_has_name(gst_caps_get_structure(caps, 0), GST_TACTILE_MAP_MEDIA_TYPE))
    return TRUE;
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  gst_query_add_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, nullptr);
  if (gst_video_info_from_caps(&info, caps)) {
    const double fps = info.fps_n > 0 ? static_cast<double>(info.fps_n) / info.fps_d : 30.0;
    const double lead = static_cast<double>(gst_base_sink_get_render_delay(sink)) / GST_SECOND;
    const guint frames = static_cast<guint>(std::min(std::ceil(lead * fps) + 1, 256.0));
    gst_query_add_allocation_pool(
        query, nullptr, static_cast<guint>(std::min<gsize>(info.size, G_MAXUINT)), frames, 0);
    GST_DEBUG_OBJECT(self, "asking for at least %u buffers", frames);
  }
  return TRUE;
}

/* ---- life ---- */

/// How much earlier than a frame's time its data is asked for, given the longest latency on the way
/// to a motor.
static GstClockTime
lead_of(const TactorOpening &opening)
{
  const Time early = opening.planner.max_lead + opening.latency + kWakeMargin;
  return static_cast<GstClockTime>(early.count());
}

/// Begins to open board and trace, both anew for each play. What is wrong with the settings becomes
/// an error message and FALSE; what is wrong with the board becomes an error message later.
static gboolean
gst_tactor_sink_open(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;

  GST_OBJECT_LOCK(self);
  const TactorSettings settings = priv->settings;
  priv->limited = {};
  GST_OBJECT_UNLOCK(self);
  if (!settings.mapping_error.empty()) {
    GST_ELEMENT_ERROR(self, LIBRARY, SETTINGS,
                      ("mapping cannot be read: %s.", settings.mapping_error.c_str()), (nullptr));
    return FALSE;
  }
  priv->scheduler.stop(); // of a play whose opening failed
  tl::expected<TactorOpening, tactor::DriverError> prepared
      = prepare_tactors(GST_ELEMENT(self), settings);
  if (!prepared) {
    tactor_post_open_error(GST_ELEMENT(self), prepared.error());
    return FALSE;
  }
  priv->opening = std::move(*prepared);
  priv->is_open = false;
  priv->last_lead_short.reset();
  priv->ended = false;
  // What the board adds is not known yet; what it added in the last play may well hold.
  GstBaseSink *sink = GST_BASE_SINK(self);
  gst_base_sink_set_render_delay(
      sink, std::max(gst_base_sink_get_render_delay(sink), lead_of(priv->opening)));
  priv->scheduler.set_immediate(!gst_base_sink_get_sync(GST_BASE_SINK(self)));
  priv->scheduler.set_muted(settings.mute);
  priv->scheduler.set_ramp_in(settings.ramp_in);
  const auto open = [self, priv](std::stop_token stop) {
    return open_tactors(
               GST_ELEMENT(self), priv->opening,
               [priv](const tactor::DriverEvent &event) { priv->device_event(event); },
               std::move(stop))
        .map([self, priv](TactorOutput &&output) {
          gst_base_sink_set_render_delay(GST_BASE_SINK(self), lead_of(priv->opening));
          return std::move(output);
        });
  };
  if (const tl::expected<void, tactor::DriverError> started
      = priv->scheduler.start(open, settings.planner.volts_max, settings.realtime);
      !started) {
    priv->opening.turn.reset();
    tactor_post_open_error(GST_ELEMENT(self), started.error());
    return FALSE;
  }
  return TRUE;
}

static void
gst_tactor_sink_close(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;
  priv->scheduler.flush(); // the trace, too
  if (priv->scheduler.trace_failed())
    GST_ELEMENT_WARNING(self, RESOURCE, WRITE, ("The command trace is incomplete."),
                        ("writing to it failed: is the disk full?"));
  priv->scheduler.stop();
}

static GstStateChangeReturn
gst_tactor_sink_change_state(GstElement *element, GstStateChange transition)
{
  GstTactorSink *self = GST_TACTOR_SINK(element);
  GstTactorSinkPrivate *priv = self->priv;

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !gst_tactor_sink_open(self))
    return GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    priv->scheduler.pause();
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING
      || transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    priv->queue_watch.stop();

  GstStateChangeReturn ret = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);

  // A pause waits for no map: nothing is shown, and with a picture that is shown later none may
  // come before it goes on.
  if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED && ret == GST_STATE_CHANGE_ASYNC) {
    gst_element_post_message(element,
                             gst_message_new_async_done(GST_OBJECT(element), GST_CLOCK_TIME_NONE));
    ret = GST_STATE_CHANGE_SUCCESS;
  }
  // The base class also begins to play on the streaming thread, after a preroll, while the
  // application may be pausing.
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING && ret != GST_STATE_CHANGE_FAILURE)
    priv->scheduler.play([element] { return GST_STATE_TARGET(element) == GST_STATE_PLAYING; });
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && ret != GST_STATE_CHANGE_FAILURE)
    priv->queue_watch.start([priv] { return priv->scheduler.is_open(); });
  // After a failure nothing is left running either, also if it was told when the change of state
  // had returned.
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY || transition == GST_STATE_CHANGE_READY_TO_NULL
      || (transition == GST_STATE_CHANGE_READY_TO_PAUSED && ret == GST_STATE_CHANGE_FAILURE))
    gst_tactor_sink_close(self);
  return ret;
}

static gboolean
gst_tactor_sink_send_event(GstElement *element, GstEvent *event)
{
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(element)->priv;
  const GstEventType type = GST_EVENT_TYPE(event);
  // The base class would wait for something to stop at, and have the whole pipeline wait.
  if (type == GST_EVENT_STEP && priv->ended) {
    gst_event_unref(event);
    priv->scheduler.flush();
    return TRUE;
  }
  const gboolean handled = GST_ELEMENT_CLASS(parent_class)->send_event(element, event);
  if (type == GST_EVENT_LATENCY)
    priv->scheduler.timing_changed();
  return handled;
}

static void
gst_tactor_sink_timing_notify(GObject *object, GParamSpec *, gpointer)
{
  GST_TACTOR_SINK(object)->priv->scheduler.timing_changed();
}

static void
gst_tactor_sink_sync_notify(GObject *object, GParamSpec *, gpointer)
{
  GST_TACTOR_SINK(object)->priv->scheduler.set_immediate(
      !gst_base_sink_get_sync(GST_BASE_SINK(object)));
}

/* ---- properties ---- */

static void
gst_tactor_sink_set_property(GObject *object, guint id, const GValue *value, GParamSpec *pspec)
{
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(object)->priv;
  GST_OBJECT_LOCK(object);
  const bool known = priv->settings.set(id, value);
  const bool mute = priv->settings.mute;
  const Time ramp_in = priv->settings.ramp_in;
  const std::string error = id == TACTOR_PROP_MAPPING ? priv->settings.mapping_error : "";
  GST_OBJECT_UNLOCK(object);
  if (!known)
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
  else if (!error.empty())
    GST_ELEMENT_WARNING(object, LIBRARY, SETTINGS, ("mapping stays as it was: %s.", error.c_str()),
                        (nullptr));
  else if (id == TACTOR_PROP_MUTE)
    priv->scheduler.set_muted(mute);
  else if (id == TACTOR_PROP_RAMP_IN)
    priv->scheduler.set_ramp_in(ramp_in);
}

static void
gst_tactor_sink_get_property(GObject *object, guint id, GValue *value, GParamSpec *pspec)
{
  if (id == TACTOR_PROP_STATS) {
    g_value_take_boxed(value, gst_tactor_sink_stats(GST_TACTOR_SINK(object)));
    return;
  }
  GST_OBJECT_LOCK(object);
  const bool known = GST_TACTOR_SINK(object)->priv->settings.get(id, value);
  GST_OBJECT_UNLOCK(object);
  if (!known)
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
}

static void
gst_tactor_sink_finalize(GObject *object)
{
  delete GST_TACTOR_SINK(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactor_sink_class_init(GstTactorSinkClass *klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS(klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);
  GstBaseSinkClass *sink_class = GST_BASE_SINK_CLASS(klass);

  object_class->set_property = gst_tactor_sink_set_property;
  object_class->get_property = gst_tactor_sink_get_property;
  object_class->finalize = gst_tactor_sink_finalize;
  TactorSettings::install(object_class);

  gst_element_class_set_static_metadata(
      element_class, "Tactor sink", "Sink/Hardware",
      "Plays tactile maps on vibration motors, early by their rise time",
      "The visuotactile authors");
  gst_element_class_add_static_pad_template(element_class, &sink_template);

  element_class->change_state = gst_tactor_sink_change_state;
  element_class->send_event = gst_tactor_sink_send_event;
  element_class->post_message = gst_tactor_sink_post_message;
  sink_class->set_caps = gst_tactor_sink_set_caps;
  sink_class->propose_allocation = gst_tactor_sink_propose_allocation;
  sink_class->event = gst_tactor_sink_event;
  sink_class->wait_event = gst_tactor_sink_wait_event;
  sink_class->render = gst_tactor_sink_render;
  sink_class->unlock = gst_tactor_sink_unlock;
  sink_class->unlock_stop = gst_tactor_sink_unlock_stop;
}

static void
gst_tactor_sink_init(GstTactorSink *self)
{
  GstBaseSink *sink = GST_BASE_SINK(self);
  self->priv = new GstTactorSinkPrivate(self);

  // Never the cause of an upstream drop: a late map is still better than none.
  gst_base_sink_set_sync(sink, TRUE);
  gst_base_sink_set_qos_enabled(sink, FALSE);
  gst_base_sink_set_max_lateness(sink, -1);
  gst_base_sink_set_last_sample_enabled(sink, FALSE);
  g_signal_connect(self, "notify::ts-offset", G_CALLBACK(gst_tactor_sink_timing_notify), nullptr);
  g_signal_connect(self, "notify::sync", G_CALLBACK(gst_tactor_sink_sync_notify), nullptr);
}
