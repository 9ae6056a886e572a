// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactorsink
 * @title: tactorsink
 * @short_description: plays tactile maps on vibration motors, early by their rise time
 *
 * tactorsink receives video frames with a #GstTactileMeta, or a stream of tactile maps
 * (`application/x-tactile-map`), and drives one vibration motor (tactor) for each cell.
 *
 * A coin motor needs up to 180 ms to reach 90 % of its level. The element therefore issues each
 * command that much before its frame, and delays all other sinks by #GstTactorSink:max-lead and 10
 * ms. Put a queue with `max-size-bytes=0 max-size-buffers=0 max-size-time=400000000` before each
 * sink, as in [tactileextractor](tactileextractor.md).
 *
 * The element plays #GstTactorSink:rate maps a second, and at once those of a stream of maps to
 * which soundtactile added.
 *
 * All motors are at zero after a pause, a flush, the end of the stream, an error, and when
 * upstream stops sending. [From map to motor](../design/tactorsink.md) covers killed processes,
 * real-time threads and slow lines.
 *
 * ## Boards
 * A thread opens the board from READY to PAUSED, in up to five seconds, for which the stream
 * waits; a live stream begins without it. If the board cannot be used, the element posts an error.
 * If it is unplugged, the element posts one warning, the film plays on, and the board resumes when
 * it is back.
 *
 * Without #GstTactorSink:device, the element uses the first known board that answers. A board
 * becomes known when it is named once, because an unknown device may be a 3D printer, which a
 * probe resets. `driver=auto` does not touch unknown devices; `driver=firmata` and `driver=seat`
 * probe one that is alone. The element never uses a port that another program has open. See [which
 * board is taken](../design/tactorsink.md#which-board-is-taken).
 *
 * As a `GstURIHandler`, the element plays on `tactor://SERIAL`, the board with that serial number
 * or bus path.
 *
 * ## Gamepads
 * `driver=gamepad` drives rumble motors through SDL, which no other driver loads. Without
 * #GstTactorSink:mapping, the left half of the map is the low-frequency motor, tactor 0, and the
 * right half the high-frequency one, tactor 1. Tactors 2 and 3 are motors in the triggers. See [a
 * gamepad as a chair](../hardware/gamepad.md).
 *
 * ## Vests, and devices of Intiface
 * `driver=bhaptics` drives a suit of bHaptics and `driver=intiface` the device that
 * #GstTactorSink:device names, through a server on this or another computer. A map of any grid is
 * pooled to their motors; if a cell has several motors, #GstTactorSink:max-active counts cells.
 * The picture also waits for the server, [up to 150
 * ms](../design/tactorsink.md#latency-of-a-server). See [a vest as a chair](../hardware/vest.md)
 * and [a device of Intiface as a chair](../hardware/intiface.md).
 *
 * ## The grid
 * A device with a layout, such as a vest or a gamepad, prefers maps of its own grid and accepts
 * any other. saliencytactile, also before a tactileextractor, and soundtactile use that grid
 * unless theirs is set. The grid is known once the device is open: earlier maps may be 3 × 3. With
 * two devices behind a tee, the grid is that of the first one. With #GstTactorSink:mapping there
 * is no preference.
 *
 * ## Limits
 * #GstTactorSink:max-on-time, #GstTactorSink:max-duty and #GstTactorSink:max-active protect motors
 * and skin. A cue that a limit has cut begins again after the film has released its tactor, or
 * after 3 s. Pauses, seeks and mute do not reset the limits, nor does the next play on the same
 * device in this process. The thread of the device cuts late levels by the clock of the motor.
 *
 * ## Streams with faults
 * A frame without a time stamp plays when it arrives; without a frame rate the element posts a
 * warning. A GAP for lost packets does not end a cue, unlike other GAPs: the last map holds for a
 * second at most.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! \
 *     tactorsink trace-location=commands.csv
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! \
 *     tactorsink rate=15 intensity=0.7 driver=simulator device=amplitude.csv
 * ]|
 *
 * ## Statistics
 * The fields of #GstTactorSink:actuation-stats; times are in ns:
 * - `issued`, `late` (by more than 5 ms), `came-late` (late because of the map), `thread-late`
 *   (late because of the thread)
 * - `coalesced` (replaced by newer commands), `dropped` (by a flush), `expired` (arrived too late
 *   to be felt), `overtaken` (replaced before the thread of the driver sent them)
 * - `starved`: how often no map arrived and the motors were stopped
 * - `cut-on-time`, `cut-duty`, `cut-active`, `ramps`: limited cues, soft starts
 * - `cut-driver`: levels that the driver ended because the command was late
 * - `error-min`, `error-mean`, `error-p50`, `error-p99`, `error-max`: issued − due
 * - `thread-p99`, `thread-max`: delays of the thread
 * - `latency`: time to the motors, by which commands are issued earlier
 * - `scheduling`: `direct`, `rtkit`, `portal`, `given-back` or `normal`
 * - `board`, `firmware`, `pins`, `connected`, `watchdog`, `reconnects`, `bytes`
 * - `guardian`: `running`, or the reason why there is none; empty if none is needed
 * - `may-run`: the board is closed, but its motors may still be on
 *
 * ## Messages
 * - `tactor-lead-short` (`lead`, `late`): a command was too late for its motor.
 * - `tactor-line-slow` (`tactors`, `bytes`, `update`, `at-once`): the serial line is too slow for
 *   the chair.
 * - `tactor-device-lost`, `tactor-device-found`: the board disappeared, or is back.
 * - `tactor-device-refused` (`reason`): the board is back but cannot be used.
 * - `tactor-device-not-stopped` (`reason`): motors may still be on. The element also writes this
 *   to standard error, because the application may have stopped reading messages.
 * - `tactor-stats`: #GstTactorSink:actuation-stats at the end of the stream.
 * - A warning before PAUSED: one thread feeds this and another sink without queues between them,
 *   so that the pipeline waits forever.
 *
 * Since: 0.1
 */
#include "gsttactorsink.h"

#include "../gaps.h"
#include "../pooldemand.h"
#include "queuewatch.h"
#include "tactormessages.h"
#include "tactorplay.h"
#include "tactorsession.h"
#include "tactorsettings.h"
#include "tactorurihandler.h"
#include "unlockedposts.h"

#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

struct GstTactorSinkPrivate
{
  explicit GstTactorSinkPrivate(GstTactorSink *sink)
      : session(GST_BASE_SINK(sink)), play(GST_BASE_SINK(sink), session),
        queue_watch(GST_ELEMENT(sink))
  {
  }

  TactorSettings settings; ///< guarded by the object lock

  TactorSession session;
  TactorPlay play;
  std::atomic<bool> ended{ false }; ///< end of stream
  UnlockedPosts posts;

  std::atomic<bool> flushed{ false }; ///< no map has come since the last flush
  ClockRest clock_rest;

  QueueWatch queue_watch; ///< changes of state only
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

static TactorScheduler &
scheduler_of(gpointer sink)
{
  return GST_TACTOR_SINK(sink)->priv->session.scheduler();
}

static GstStructure *
gst_tactor_sink_stats(GObject *object)
{
  const TactorScheduler &scheduler = scheduler_of(object);
  return tactor_stats_new(scheduler.counters(), scheduler.driver_status(),
                          scheduler.transport_latency(),
                          GST_TACTOR_SINK(object)->priv->play.limited(), scheduler.scheduling());
}

/* ---- the stream ---- */

static GstFlowReturn
gst_tactor_sink_render(GstBaseSink *sink, GstBuffer *buffer)
{
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(sink)->priv;

  if (const GstFlowReturn ret = priv->play.wait_until_open(); ret != GST_FLOW_OK)
    return ret;
  GST_OBJECT_LOCK(sink);
  const GstSegment segment = sink->segment;
  GST_OBJECT_UNLOCK(sink);
  properties::sync_values(sink, segment, GST_BUFFER_PTS(buffer));
  if (scheduler_of(sink).failed())
    return GST_FLOW_ERROR; // the error message was posted before
  GST_OBJECT_LOCK(sink);
  tactor::PlannerSettings settings = priv->settings.planner;
  GST_OBJECT_UNLOCK(sink);
  const UnlockedPosts::Scope locked(priv->posts);
  return priv->play.play_map(buffer, std::move(settings));
}

static GstFlowReturn
gst_tactor_sink_wait_event(GstBaseSink *sink, GstEvent *event)
{
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(sink)->priv;

  GstFlowReturn ret = GST_BASE_SINK_CLASS(parent_class)->wait_event(sink, event);
  if (ret != GST_FLOW_OK)
    return ret;

  if (GST_EVENT_TYPE(event) == GST_EVENT_GAP && !is_loss(event)) {
    GstClockTime pts;
    GstClockTime length;
    gst_event_parse_gap(event, &pts, &length);
    priv->play.play_gap(pts, length);
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_EOS) {
    priv->ended = true;
    ret = priv->play.drain();
    if (ret == GST_FLOW_OK) {
      const UnlockedPosts::Scope locked(priv->posts);
      tactor_post_stats(GST_ELEMENT(sink), gst_tactor_sink_stats(G_OBJECT(sink)));
      ret = sink->flushing ? GST_FLOW_FLUSHING : GST_FLOW_OK;
    }
  }
  return ret;
}

static gboolean
gst_tactor_sink_unlock(GstBaseSink *sink)
{
  scheduler_of(sink).interrupt(true);
  return TRUE;
}

static gboolean
gst_tactor_sink_unlock_stop(GstBaseSink *sink)
{
  scheduler_of(sink).interrupt(false);
  return TRUE;
}

static gboolean
gst_tactor_sink_event(GstBaseSink *sink, GstEvent *event)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  GstTactorSinkPrivate *priv = self->priv;
  const GstEventType type = GST_EVENT_TYPE(event);

  // The base class holds the preroll lock for these.
  if ((gst_event_type_get_flags(type) & GST_EVENT_TYPE_SERIALIZED) && type != GST_EVENT_FLUSH_STOP
      && priv->play.wait_until_open() != GST_FLOW_OK) {
    gst_event_unref(event);
    return FALSE;
  }

  gboolean resets_time = FALSE;
  if (type == GST_EVENT_FLUSH_STOP)
    gst_event_parse_flush_stop(event, &resets_time);

  const gboolean handled = GST_BASE_SINK_CLASS(parent_class)->event(sink, event);
  if (type == GST_EVENT_FLUSH_STOP || type == GST_EVENT_STREAM_START)
    priv->ended = false;
  if (type == GST_EVENT_FLUSH_STOP)
    priv->flushed = true;
  // Afterwards: only now the streaming thread has left render().
  if (type == GST_EVENT_FLUSH_START)
    priv->play.flush_started();
  else if (type == GST_EVENT_FLUSH_STOP)
    priv->play.flush_stopped(resets_time);
  return handled;
}

/// Maps that have waited for the play come all at once, and the clock would be read for each. A
/// sink that does not preroll (async=false) knows by the first map after a flush that it plays.
static GstPadProbeReturn
gst_tactor_sink_settle(GstPad *, GstPadProbeInfo *, gpointer user_data)
{
  auto *self = GST_TACTOR_SINK(user_data);
  if (self->priv->flushed.exchange(false) && GST_STATE(self) == GST_STATE_PLAYING)
    self->priv->clock_rest.begin(self->priv->session.read_timing());
  std::this_thread::sleep_until(self->priv->clock_rest.end());
  return GST_PAD_PROBE_OK;
}

/// Steps are known by their message: the base class posts it on the streaming thread, before the
/// next buffer.
static gboolean
gst_tactor_sink_post_message(GstElement *element, GstMessage *message)
{
  gboolean flush = FALSE;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_DONE)
    gst_message_parse_step_done(message, nullptr, nullptr, nullptr, &flush, nullptr, nullptr,
                                nullptr);
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(element)->priv;
  if (flush)
    priv->play.stepped();
  return priv->posts.post(GST_BASE_SINK(element), [&] {
    return GST_ELEMENT_CLASS(parent_class)->post_message(element, message);
  });
}

static GstCaps *
gst_tactor_sink_get_caps(GstBaseSink *sink, GstCaps *filter)
{
  return GST_TACTOR_SINK(sink)->priv->session.grid().caps(filter);
}

static gboolean
gst_tactor_sink_query(GstBaseSink *sink, GstQuery *query)
{
  return GST_TACTOR_SINK(sink)->priv->session.grid().answer(query)
         || GST_BASE_SINK_CLASS(parent_class)->query(sink, query);
}

static gboolean
gst_tactor_sink_set_caps(GstBaseSink *sink, GstCaps *caps)
{
  GstTactorSink *self = GST_TACTOR_SINK(sink);
  if (self->priv->play.set_caps(caps))
    return TRUE;
  GST_ERROR_OBJECT(self, "expected rows and columns from 1 to %d, got %" GST_PTR_FORMAT,
                   GST_TACTILE_MAX_SIDE, caps);
  return FALSE;
}

/// Requests a pool as large as the lead, for a queue before this sink. Upstream may keep its
/// strides.
static gboolean
gst_tactor_sink_propose_allocation(GstBaseSink *sink, GstQuery *query)
{
  GstCaps *caps;

  gst_query_parse_allocation(query, &caps, nullptr);
  if (!caps)
    return FALSE;
  gst_query_add_allocation_meta(query, GST_TACTILE_META_API_TYPE, nullptr);
  if (gst_structure_has_name(gst_caps_get_structure(caps, 0), GST_TACTILE_MAP_MEDIA_TYPE))
    return TRUE;
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  gst_query_add_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, nullptr);
  demand_buffers(query, gst_base_sink_get_render_delay(sink));
  return TRUE;
}

/* ---- life ---- */

/// Hands a setting to its user, and again if another thread changes it meanwhile: the last value
/// there is that of the property.
template <class User, class Value>
static void
gst_tactor_sink_apply(GstTactorSink *self, User &user, Value (TactorSettings::*read)() const,
                      void (User::*set)(Value))
{
  for (std::optional<Value> applied;;) {
    GST_OBJECT_LOCK(self);
    const Value value = (self->priv->settings.*read)();
    GST_OBJECT_UNLOCK(self);
    if (applied == value)
      return;
    (user.*set)(value);
    applied = value;
  }
}

static bool
gst_tactor_sink_open(GstTactorSink *self)
{
  GstTactorSinkPrivate *priv = self->priv;

  gst_tactor_sink_apply(self, scheduler_of(self), &TactorSettings::is_silent,
                        &TactorScheduler::set_muted);
  gst_tactor_sink_apply(self, scheduler_of(self), &TactorSettings::ramp_in_time,
                        &TactorScheduler::set_ramp_in);
  GST_OBJECT_LOCK(self);
  const TactorSettings settings = priv->settings;
  GST_OBJECT_UNLOCK(self);
  priv->play.begin();
  priv->ended = false;
  return priv->session.open(settings);
}

static GstStateChangeReturn
gst_tactor_sink_change_state(GstElement *element, GstStateChange transition)
{
  GstTactorSink *self = GST_TACTOR_SINK(element);
  GstTactorSinkPrivate *priv = self->priv;

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !gst_tactor_sink_open(self))
    return GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    scheduler_of(self).pause();
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING
      || transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    priv->queue_watch.stop();

  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING)
    priv->clock_rest.begin(priv->session.read_timing());
  GstStateChangeReturn ret = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);

  // A pause does not wait for a map. None may come before the play goes on, if the picture is shown
  // later than the maps.
  if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED && ret == GST_STATE_CHANGE_ASYNC) {
    gst_element_post_message(element,
                             gst_message_new_async_done(GST_OBJECT(element), GST_CLOCK_TIME_NONE));
    ret = GST_STATE_CHANGE_SUCCESS;
  }
  // After a preroll this runs on the streaming thread, while the application may be pausing.
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING && ret != GST_STATE_CHANGE_FAILURE)
    scheduler_of(self).play([element] { return GST_STATE_TARGET(element) == GST_STATE_PLAYING; });
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && ret != GST_STATE_CHANGE_FAILURE)
    priv->queue_watch.start([self] { return scheduler_of(self).is_open(); });
  // Also after a failure, whether it came during this change of state or later.
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY || transition == GST_STATE_CHANGE_READY_TO_NULL
      || (transition == GST_STATE_CHANGE_READY_TO_PAUSED && ret == GST_STATE_CHANGE_FAILURE))
    priv->session.close();
  return ret;
}

static gboolean
gst_tactor_sink_send_event(GstElement *element, GstEvent *event)
{
  GstTactorSinkPrivate *priv = GST_TACTOR_SINK(element)->priv;
  const GstEventType type = GST_EVENT_TYPE(event);
  // The base class would wait for a frame to stop at, and with it the whole pipeline.
  if (type == GST_EVENT_STEP && priv->ended) {
    gst_event_unref(event);
    scheduler_of(element).flush();
    return TRUE;
  }
  const gboolean handled = GST_ELEMENT_CLASS(parent_class)->send_event(element, event);
  if (type == GST_EVENT_LATENCY)
    priv->session.timing_changed();
  return handled;
}

static void
gst_tactor_sink_timing_notify(GObject *object, GParamSpec *, gpointer)
{
  GST_TACTOR_SINK(object)->priv->session.timing_changed();
}

static void
gst_tactor_sink_sync_notify(GObject *object, GParamSpec *, gpointer)
{
  scheduler_of(object).set_immediate(!gst_base_sink_get_sync(GST_BASE_SINK(object)));
}

/* ---- properties ---- */

static TactorSettings &
gst_tactor_sink_settings(GObject *object)
{
  return GST_TACTOR_SINK(object)->priv->settings;
}

static void
gst_tactor_sink_property_changed(GObject *object, std::string_view name)
{
  GstTactorSink *self = GST_TACTOR_SINK(object);
  GST_OBJECT_LOCK(object);
  const std::string error = self->priv->settings.mapping_error;
  GST_OBJECT_UNLOCK(object);
  if (name == "mapping" && !error.empty())
    GST_ELEMENT_WARNING(object, LIBRARY, SETTINGS, ("mapping stays as it was: %s.", error.c_str()),
                        (nullptr));
  else if (name == "mute" || name == "intensity")
    gst_tactor_sink_apply(self, scheduler_of(self), &TactorSettings::is_silent,
                          &TactorScheduler::set_muted);
  else if (name == "delay")
    gst_tactor_sink_apply(self, self->priv->session, &TactorSettings::delay_time,
                          &TactorSession::set_delay);
  else if (name == "ramp-in")
    gst_tactor_sink_apply(self, scheduler_of(self), &TactorSettings::ramp_in_time,
                          &TactorScheduler::set_ramp_in);
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

  object_class->finalize = gst_tactor_sink_finalize;
  TactorSettings::install(
      object_class,
      { gst_tactor_sink_settings, gst_tactor_sink_property_changed, gst_tactor_sink_stats });

  gst_element_class_set_static_metadata(
      element_class, "Tactor sink", "Sink/Hardware",
      "Plays tactile maps on vibration motors, early by their rise time",
      "The visuotactile authors");
  gst_element_class_add_static_pad_template(element_class, &sink_template);

  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactor_sink_change_state);
  element_class->send_event = GST_DEBUG_FUNCPTR(gst_tactor_sink_send_event);
  element_class->post_message = GST_DEBUG_FUNCPTR(gst_tactor_sink_post_message);
  sink_class->get_caps = GST_DEBUG_FUNCPTR(gst_tactor_sink_get_caps);
  sink_class->query = GST_DEBUG_FUNCPTR(gst_tactor_sink_query);
  sink_class->set_caps = GST_DEBUG_FUNCPTR(gst_tactor_sink_set_caps);
  sink_class->propose_allocation = GST_DEBUG_FUNCPTR(gst_tactor_sink_propose_allocation);
  sink_class->event = GST_DEBUG_FUNCPTR(gst_tactor_sink_event);
  sink_class->wait_event = GST_DEBUG_FUNCPTR(gst_tactor_sink_wait_event);
  sink_class->render = GST_DEBUG_FUNCPTR(gst_tactor_sink_render);
  sink_class->unlock = GST_DEBUG_FUNCPTR(gst_tactor_sink_unlock);
  sink_class->unlock_stop = GST_DEBUG_FUNCPTR(gst_tactor_sink_unlock_stop);
}

static void
gst_tactor_sink_init(GstTactorSink *self)
{
  GstBaseSink *sink = GST_BASE_SINK(self);
  self->priv = new GstTactorSinkPrivate(self);
  gst_pad_add_probe(GST_BASE_SINK_PAD(sink), GST_PAD_PROBE_TYPE_BUFFER, gst_tactor_sink_settle,
                    self, nullptr);

  // No drops for this sink's sake: a late map is better than none.
  gst_base_sink_set_sync(sink, TRUE);
  gst_base_sink_set_qos_enabled(sink, FALSE);
  gst_base_sink_set_max_lateness(sink, -1);
  gst_base_sink_set_last_sample_enabled(sink, FALSE);
  g_signal_connect(self, "notify::ts-offset", G_CALLBACK(gst_tactor_sink_timing_notify), nullptr);
  g_signal_connect(self, "notify::sync", G_CALLBACK(gst_tactor_sink_sync_notify), nullptr);
}
