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
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactorsink trace-location=commands.csv
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! videoconvert ! autovideosink \
 *     x.tactile ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! tactorsink
 * ]|
 *
 * ## Messages
 * - `tactor-lead-short`: a command could not be issued as early as its motor needs; fields `lead`
 *   and `late` (#guint64, ns). At most one in five seconds.
 * - `tactor-device-lost`, `tactor-device-found`: the board went away, came back.
 * - `tactor-stats`: the contents of #GstTactorSink:stats at the end of the stream.
 *
 * Since: 0.1
 */
#include "gsttactorsink.h"

#include "tactor/command_planner.h"
#include "tactorscheduler.h"
#include "tactorsettings.h"

#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

using tactor::Time;

GST_DEBUG_CATEGORY_STATIC(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

namespace {

/// Data is asked for this much before the earliest command can be due: the time that planning and a
/// wake-up take.
constexpr Time kWakeMargin = std::chrono::milliseconds(10);

/// A map is held at most this long after the end of its frame if no other follows.
constexpr Time kHold = std::chrono::seconds(1);

/// At most one message about short leads in this time.
constexpr Time kLeadShortInterval = std::chrono::seconds(5);

/// The grid and timing of the stream as last negotiated; streaming thread only.
struct Stream
{
  bool is_map = false; ///< application/x-tactile-map rather than video
  guint rows = 0;
  guint columns = 0;
  Time frame_duration{ 0 }; ///< 0: unknown
};

Time
to_time(GstClockTime time)
{
  return Time(static_cast<gint64>(time));
}

} // namespace

struct GstTactorSinkPrivate final : TactorSchedulerHost
{
  explicit GstTactorSinkPrivate(GstTactorSink *sink) : element(GST_ELEMENT(sink)), scheduler(*this)
  {
  }

  Timing timing() override;
  void device_lost(const tactor::DriverError &error) override;
  void device_found() override;
  void device_failed(const tactor::DriverError &error) override;
  void lead_short(Time lead, Time late) override;

  GstElement *element;         ///< not owned: this is its private part
  TactorSettings settings;     ///< guarded by the object lock
  int board_tactors = 0;       ///< of the open driver
  Time transport_latency{ 0 }; ///< of the open driver

  Stream stream;
  std::optional<tactor::CommandPlanner> planner;
  Time last_end{ 0 }; ///< running time of the end of the last map
  bool warned_no_meta = false;
  bool warned_grid = false;
  std::vector<gfloat> levels;

  std::optional<Time> last_lead_short; ///< scheduler's thread only

  TactorScheduler scheduler; ///< last: its thread ends before anything that it uses
};

struct _GstTactorSink
{
  GstBaseSink parent;
  GstTactorSinkPrivate *priv;
};

#define gst_tactor_sink_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactorSink, gst_tactor_sink, GST_TYPE_BASE_SINK,
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

void
GstTactorSinkPrivate::device_lost(const tactor::DriverError &error)
{
  GST_ELEMENT_WARNING(element, RESOURCE, NOT_FOUND,
                      ("The tactor board is gone; the film plays on."), ("%s", error.what()));
  gst_element_post_message(
      element, gst_message_new_element(GST_OBJECT(element),
                                       gst_structure_new("tactor-device-lost", "reason",
                                                         G_TYPE_STRING, error.what(), nullptr)));
}

void
GstTactorSinkPrivate::device_found()
{
  GST_INFO_OBJECT(element, "the tactor board is back");
  gst_element_post_message(
      element,
      gst_message_new_element(GST_OBJECT(element), gst_structure_new_empty("tactor-device-found")));
}

void
GstTactorSinkPrivate::device_failed(const tactor::DriverError &error)
{
  GST_ELEMENT_ERROR(element, RESOURCE, WRITE, ("%s", error.what()), (nullptr));
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
  GST_WARNING_OBJECT(element,
                     "a command that needs a lead of %" GST_STIME_FORMAT
                     " was late by %" GST_STIME_FORMAT
                     ": is there a queue with max-size-bytes=0 max-size-buffers=0 and enough "
                     "max-size-time before each sink?",
                     GST_STIME_ARGS(lead.count()), GST_STIME_ARGS(late.count()));
  gst_element_post_message(
      element, gst_message_new_element(
                   GST_OBJECT(element),
                   gst_structure_new("tactor-lead-short", "lead", G_TYPE_UINT64,
                                     static_cast<guint64>(lead.count()), "late", G_TYPE_UINT64,
                                     static_cast<guint64>(late.count()), nullptr)));
}

/* ---- statistics ---- */

static GstStructure *
gst_tactor_sink_stats(GstTactorSink *self)
{
  const TactorScheduler::Counters counters = self->priv->scheduler.counters();
  const auto ns = [](Time time) {
    return static_cast<gint64>(time.count());
  };
  return gst_structure_new("application/x-tactor-stats", "issued", G_TYPE_UINT64, counters.issued,
                           "late", G_TYPE_UINT64, counters.late, "coalesced", G_TYPE_UINT64,
                           counters.coalesced, "dropped", G_TYPE_UINT64, counters.dropped,
                           "starved", G_TYPE_UINT64, counters.starved, "reconnects", G_TYPE_UINT64,
                           counters.reconnects, "error-min", G_TYPE_INT64, ns(counters.error.min()),
                           "error-mean", G_TYPE_INT64, ns(counters.error.mean()), "error-p50",
                           G_TYPE_INT64, ns(counters.error.percentile(0.5)), "error-p99",
                           G_TYPE_INT64, ns(counters.error.percentile(0.99)), "error-max",
                           G_TYPE_INT64, ns(counters.error.max()), nullptr);
}

/* ---- planning (streaming thread) ---- */

static tactor::PlannerSettings
gst_tactor_sink_planner_settings(GstTactorSink *self)
{
  GST_OBJECT_LOCK(self);
  tactor::PlannerSettings settings = self->priv->settings.planner;
  GST_OBJECT_UNLOCK(self);
  settings.transport_latency = self->priv->transport_latency;
  return settings;
}

/// A planner for the grid of the map at hand and the mapping that is set; what the motors do for the
/// old ones ends at `time`.
static void
gst_tactor_sink_set_grid(GstTactorSink *self, guint rows, guint columns, Time time)
{
  GstTactorSinkPrivate *priv = self->priv;
  const tactor::PlannerSettings settings = gst_tactor_sink_planner_settings(self);
  if (priv->planner && priv->stream.rows == rows && priv->stream.columns == columns
      && priv->planner->settings().mapping == settings.mapping)
    return;
  if (priv->planner)
    priv->scheduler.push(priv->planner->silence(time), time + kHold);
  priv->stream.rows = rows;
  priv->stream.columns = columns;

  const int cells = static_cast<int>(rows * columns);
  const int wanted
      = settings.mapping.empty() ? cells : 1 + *std::ranges::max_element(settings.mapping);
  GST_INFO_OBJECT(self, "grid of %u x %u, %d tactors wanted, the board has %d", rows, columns,
                  wanted, priv->board_tactors);
  const std::string problem
      = tactor::CommandPlanner::validate_mapping(settings.mapping, cells, priv->board_tactors);
  if (!problem.empty() && !priv->warned_grid) {
    priv->warned_grid = true;
    GST_ELEMENT_WARNING(self, STREAM, FORMAT, ("Some cells of the film have no tactor."),
                        ("%s; set rows and columns of saliencytactile to the chair's grid, or "
                         "mapping of tactorsink",
                         problem.c_str()));
  }
  priv->planner.emplace(std::clamp(wanted, 0, priv->board_tactors), settings);
}

/// Levels of a buffer into priv->levels, and the grid they are for. False if the buffer has none.
static bool
gst_tactor_sink_read_levels(GstTactorSink *self, GstBuffer *buffer, guint &rows, guint &columns)
{
  GstTactorSinkPrivate *priv = self->priv;
  if (priv->stream.is_map) {
    rows = priv->stream.rows;
    columns = priv->stream.columns;
    g_autofree gfloat *levels = nullptr;
    gsize count = 0;
    if (!gst_tactile_map_buffer_get_levels(buffer, rows, columns, &levels, &count))
      return false;
    priv->levels.assign(levels, levels + count);
    return true;
  }
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  if (!meta)
    return false;
  rows = meta->rows;
  columns = meta->columns;
  priv->levels.assign(meta->levels, meta->levels + static_cast<gsize>(rows) * columns);
  return true;
}

/// Running time at which the buffer's frame is shown and how long, at the segment's rate. A buffer
/// without time follows the last one.
static void
gst_tactor_sink_times(GstTactorSink *self, GstClockTime pts, GstClockTime length, Time &start,
                      Time &duration)
{
  GstTactorSinkPrivate *priv = self->priv;
  GstBaseSink *sink = GST_BASE_SINK(self);

  GST_OBJECT_LOCK(self);
  const GstSegment segment = sink->segment;
  GST_OBJECT_UNLOCK(self);

  const double rate = segment.rate == 0 ? 1.0 : std::abs(segment.rate);
  duration = GST_CLOCK_TIME_IS_VALID(length) ? to_time(length) : priv->stream.frame_duration;
  GstClockTime position = pts;
  if (GST_CLOCK_TIME_IS_VALID(position)) {
    if (segment.rate < 0)
      position += static_cast<GstClockTime>(duration.count());
    if (GST_CLOCK_TIME_IS_VALID(segment.stop))
      position = std::min<GstClockTime>(position, segment.stop);
    position = std::max<GstClockTime>(position, segment.start);
  }
  duration
      = Time(static_cast<gint64>(std::min(static_cast<double>(duration.count()) / rate, 1e15)));
  const GstClockTime running = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, position);
  start = GST_CLOCK_TIME_IS_VALID(running) ? to_time(running) : priv->last_end;
}

static GstFlowReturn
gst_tactor_sink_render(GstBaseSink *sink, GstBuffer *buffer)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;

  Time start;
  Time duration;
  gst_tactor_sink_times(self, GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer), start, duration);

  guint rows = 0;
  guint columns = 0;
  const bool has_levels = gst_tactor_sink_read_levels(self, buffer, rows, columns);
  if (!has_levels && priv->stream.is_map) {
    GST_ELEMENT_ERROR(self, STREAM, FORMAT, ("A tactile map of the wrong size came."),
                      ("expected %u x %u float32 levels (%u bytes), got %" G_GSIZE_FORMAT " bytes",
                       priv->stream.rows, priv->stream.columns,
                       priv->stream.rows * priv->stream.columns * 4u, gst_buffer_get_size(buffer)));
    return GST_FLOW_ERROR;
  }
  if (!has_levels && !priv->warned_no_meta) {
    priv->warned_no_meta = true;
    GST_ELEMENT_WARNING(
        self, STREAM, FORMAT, ("The video frames carry no tactile map."),
        ("expected a GstTactileMeta on each frame; put saliencytactile before tactorsink"));
  }

  const bool starved = priv->scheduler.take_starved();
  if (has_levels)
    gst_tactor_sink_set_grid(self, rows, columns, start);
  if (!priv->planner)
    return GST_FLOW_OK;
  if (starved)
    priv->planner->reset();
  priv->planner->set_settings(gst_tactor_sink_planner_settings(self));

  priv->last_end = start + duration;
  const std::vector<tactor::Command> commands
      = has_levels ? priv->planner->plan(start, duration, priv->levels)
                   : priv->planner->silence(start);
  GST_LOG_OBJECT(self, "map at %" GST_STIME_FORMAT ": %" G_GSIZE_FORMAT " commands",
                 GST_STIME_ARGS(start.count()), commands.size());
  priv->scheduler.push(commands, priv->last_end + kHold);
  return GST_FLOW_OK;
}

/// Waits until the last map has been shown, which is later than the base class does: its wait ends
/// render-delay early.
static GstFlowReturn
gst_tactor_sink_drain(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;
  GstBaseSink *sink = GST_BASE_SINK(self);
  if (!priv->planner)
    return GST_FLOW_OK;
  priv->scheduler.push(priv->planner->silence(priv->last_end), priv->last_end + kHold);
  const GstClockTime end = static_cast<GstClockTime>(std::max<gint64>(priv->last_end.count(), 0));
  const GstFlowReturn ret
      = gst_base_sink_wait(sink, end + gst_base_sink_get_render_delay(sink), nullptr);
  if (ret == GST_FLOW_OK)
    priv->scheduler.flush();
  return ret;
}

static GstFlowReturn
gst_tactor_sink_wait_event(GstBaseSink *sink, GstEvent *event)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;

  GstFlowReturn ret = GST_BASE_SINK_CLASS(parent_class)->wait_event(sink, event);
  if (ret != GST_FLOW_OK)
    return ret;

  if (GST_EVENT_TYPE(event) == GST_EVENT_GAP && priv->planner) {
    GstClockTime pts;
    GstClockTime length;
    gst_event_parse_gap(event, &pts, &length);
    Time start;
    Time duration;
    gst_tactor_sink_times(self, pts, GST_CLOCK_TIME_IS_VALID(length) ? length : 0, start, duration);
    priv->last_end = start + duration;
    priv->scheduler.push(priv->planner->silence(start), priv->last_end + kHold);
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_EOS) {
    ret = gst_tactor_sink_drain(self);
    if (ret == GST_FLOW_OK) {
      GstStructure *stats = gst_tactor_sink_stats(self);
      gst_structure_set_name(stats, "tactor-stats");
      gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), stats));
    }
  }
  return ret;
}

static gboolean
gst_tactor_sink_event(GstBaseSink *sink, GstEvent *event)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;
  const GstEventType type = GST_EVENT_TYPE(event);

  const gboolean handled = GST_BASE_SINK_CLASS(parent_class)->event(sink, event);
  // Afterwards, since only then the streaming thread has left render().
  if (type == GST_EVENT_FLUSH_START) {
    priv->scheduler.flush();
  } else if (type == GST_EVENT_FLUSH_STOP) {
    if (priv->planner)
      priv->planner->reset();
    priv->last_end = Time(0);
  }
  return handled;
}

static gboolean
gst_tactor_sink_set_caps(GstBaseSink *sink, GstCaps *caps)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  Stream stream = priv->stream;
  gint fps_n = 0;
  gint fps_d = 1;

  stream.is_map = gst_structure_has_name(structure, GST_TACTILE_MAP_MEDIA_TYPE);
  if (stream.is_map) {
    guint rows;
    guint columns;
    if (!gst_tactile_map_caps_parse(caps, &rows, &columns, &fps_n, &fps_d)) {
      GST_ERROR_OBJECT(self, "expected rows and columns from 1 to %d, got %" GST_PTR_FORMAT,
                       GST_TACTILE_MAX_SIDE, caps);
      return FALSE;
    }
    priv->stream.is_map = true;
    gst_tactor_sink_set_grid(self, rows, columns, priv->last_end);
    stream = priv->stream;
  } else {
    gst_structure_get_fraction(structure, "framerate", &fps_n, &fps_d);
  }
  stream.frame_duration
      = fps_n > 0 ? to_time(gst_util_uint64_scale_int(GST_SECOND, fps_d, fps_n)) : Time(0);
  priv->stream = stream;
  return TRUE;
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

static gboolean
gst_tactor_sink_start(GstBaseSink *sink)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;

  GST_OBJECT_LOCK(self);
  const TactorSettings settings = priv->settings;
  GST_OBJECT_UNLOCK(self);

  try {
    const tactor::DriverConfig config{ .device = settings.device,
                                       .max_tactors = TactorSettings::kMaxTactors,
                                       .full_scale_volts = settings.planner.volts_max };
    std::unique_ptr<tactor::Driver> driver = tactor::make_driver(settings.driver);
    driver->open(config);
    std::unique_ptr<tactor::CommandTrace> trace;
    if (!settings.trace_location.empty())
      trace = std::make_unique<tactor::CommandTrace>(settings.trace_location);
    priv->board_tactors = driver->tactors();
    priv->transport_latency = driver->transport_latency();
    priv->scheduler.start(std::move(driver), config, std::move(trace));
    priv->scheduler.set_muted(settings.mute);
  } catch (const tactor::DriverError &e) {
    switch (e.kind()) {
    case tactor::DriverError::Kind::not_found:
      GST_ELEMENT_ERROR(self, RESOURCE, NOT_FOUND, ("%s", e.what()), (nullptr));
      break;
    case tactor::DriverError::Kind::busy:
      GST_ELEMENT_ERROR(self, RESOURCE, BUSY, ("%s", e.what()), (nullptr));
      break;
    case tactor::DriverError::Kind::permission:
      GST_ELEMENT_ERROR(self, RESOURCE, NOT_AUTHORIZED, ("%s", e.what()), (nullptr));
      break;
    case tactor::DriverError::Kind::settings:
      GST_ELEMENT_ERROR(self, RESOURCE, SETTINGS, ("%s", e.what()), (nullptr));
      break;
    default:
      GST_ELEMENT_ERROR(self, RESOURCE, OPEN_READ_WRITE, ("%s", e.what()), (nullptr));
      break;
    }
    return FALSE;
  } catch (const std::exception &e) {
    GST_ELEMENT_ERROR(self, RESOURCE, FAILED, ("%s", e.what()), (nullptr));
    return FALSE;
  }
  gst_base_sink_set_render_delay(
      sink, static_cast<GstClockTime>(
                (settings.planner.max_lead + priv->transport_latency + kWakeMargin).count()));
  return TRUE;
}

static gboolean
gst_tactor_sink_stop(GstBaseSink *sink)
{
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(sink)->priv;
  if (priv->scheduler.trace_failed())
    GST_ELEMENT_WARNING(sink, RESOURCE, WRITE, ("The command trace is incomplete."),
                        ("writing to it failed: is the disk full?"));
  priv->scheduler.stop();
  return TRUE;
}

static GstStateChangeReturn
gst_tactor_sink_change_state(GstElement *element, GstStateChange transition)
{
  GstTactorSink *self = GST_TACTOR_SINK(element);
  GstTactorSinkPrivate *priv = self->priv;

  switch (transition) {
  case GST_STATE_CHANGE_READY_TO_PAUSED:
    priv->planner.reset();
    priv->stream = {};
    priv->last_end = Time(0);
    priv->warned_no_meta = priv->warned_grid = false;
    priv->last_lead_short.reset();
    priv->scheduler.set_immediate(!gst_base_sink_get_sync(GST_BASE_SINK(element)));
    break;
  case GST_STATE_CHANGE_PLAYING_TO_PAUSED:
    priv->scheduler.pause();
    break;
  default:
    break;
  }

  const GstStateChangeReturn ret
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);

  switch (transition) {
  case GST_STATE_CHANGE_PAUSED_TO_PLAYING:
    if (ret != GST_STATE_CHANGE_FAILURE)
      priv->scheduler.play();
    break;
  case GST_STATE_CHANGE_PAUSED_TO_READY:
    priv->scheduler.flush();
    break;
  default:
    break;
  }
  return ret;
}

static gboolean
gst_tactor_sink_send_event(GstElement *element, GstEvent *event)
{
  const GstEventType type = GST_EVENT_TYPE(event);
  const gboolean handled = GST_ELEMENT_CLASS(parent_class)->send_event(element, event);
  if (type == GST_EVENT_LATENCY)
    GST_TACTOR_SINK(element)->priv->scheduler.timing_changed();
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
  GST_OBJECT_UNLOCK(object);
  if (!known)
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
  else if (id == TACTOR_PROP_MUTE)
    priv->scheduler.set_muted(mute);
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
  sink_class->start = gst_tactor_sink_start;
  sink_class->stop = gst_tactor_sink_stop;
  sink_class->set_caps = gst_tactor_sink_set_caps;
  sink_class->propose_allocation = gst_tactor_sink_propose_allocation;
  sink_class->event = gst_tactor_sink_event;
  sink_class->wait_event = gst_tactor_sink_wait_event;
  sink_class->render = gst_tactor_sink_render;
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
