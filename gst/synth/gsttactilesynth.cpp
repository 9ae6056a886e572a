// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactilesynth
 * @title: tactilesynth
 * @short_description: tactile maps as sound, for shakers and voice coils
 *
 * tactilesynth turns a stream of tactile maps into sound for what an amplifier drives: bass
 * shakers, exciters, voice coils. Each channel is a carrier whose amplitude is the level of its
 * cells. Any audio sink plays it on the pipeline's clock. [tactoraudiosink](tactoraudiosink.md) has
 * one with it, and [shakers](../hardware/shakers.md) says what to plug in.
 *
 * - Timestamps are running times, of each sample without drift. At other rates than 1 and in
 *   reverse, carriers keep their frequency.
 * - An amplitude changes within 12 ms, half of it before the time of the change. What is more than
 *   200 Hz from the carrier is below -60 dB of full scale.
 * - Carriers go on in silence, so that they have the phase of the time.
 * - No sample exceeds full scale: levels, gains and carriers do not exceed 1.
 *
 * ## Channels
 * Downstream's caps decide. Without a limit there is a channel for each cell, or those that
 * #GstTactilesynth:mapping names.
 * - Channels without positions (`channel-mask=(bitmask)0x0`), as many as cells or more: cell i is
 *   channel i. Fewer: they stand side by side, and each plays the strongest cell of its columns. A
 *   column in the middle of two is on both.
 * - Channels with positions: those at the back and the sides play, side by side, and LFE plays all
 *   cells; where there are none of these, those in front. Others are silent.
 *
 * Where a channel is silent or has several cells, an information message says so. What goes through
 * `audioconvert` needs a number of channels, as in the first line below: it drops channels without
 * positions that a sound card lacks.
 *
 * ## Rise time
 * What an amplifier drives takes time to vibrate, as a coin motor does. Changes come so much
 * earlier than their frame that 90 % are reached with it. #GstTactilesynth:rise-time is an
 * estimate: a resonator of quality Q, driven at its resonance f, takes ln(10) Q / (π f), which is
 * 24 ms for a Q of 2 and 60 Hz. A shaker bolted to a heavy seat rings longer, a voice coil in the
 * hand less. A #GstTactilesynth:calibration has what was measured, and makes channels equally
 * strong.
 *
 * So the sound of a time is known only when the maps up to one rise time and 6 ms later are. From a
 * live source this is latency, by which the pipeline delays all sinks. Otherwise put a queue before
 * each sink that holds more than that, as in the launch lines: maps then come early enough. What
 * begins less than that after the start of a play, or after a seek, is late by what is missing.
 *
 * ## Limits
 * Those of tactorsink, with its defaults: #GstTactilesynth:max-on-time, #GstTactilesynth:max-duty,
 * #GstTactilesynth:max-active and a soft start. A map holds until the next one, for one second at
 * most. A sink plays what it has: #GstTactilesynth:mute and what is stopped is heard no later than
 * its buffer is long, 200 ms by default.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! \
 *     videoconvert ! autovideosink \
 *     x.tactile ! queue ! tactilesynth ! audio/x-raw,channels=2 ! audioconvert ! autoaudiosink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.tactile ! tactilesynth frequency=40 waveform=sine,noise ! wavenc ! \
 *     filesink location=nine.wav
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactilesynth.h"

#include "../tactor/tactorstream.h"
#include "synth/play.h"
#include "synth/wave_file.h"
#include "synthcaps.h"
#include "synthmotors.h"
#include "synthsettings.h"
#include "tactor/command_trace.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

using synth::Play;
using synth::Time;

GST_DEBUG_CATEGORY_STATIC(tactile_synth_debug);
#define GST_CAT_DEFAULT tactile_synth_debug

namespace {

/// How long a map holds after the end of its frame if no other follows; as in tactorsink.
constexpr Time kHold = std::chrono::seconds(1);

/// Length of a buffer.
constexpr gint kBuffersPerSecond = 50;

/// Silence beyond this is a GAP rather than samples.
constexpr gint kLongestSilence = 10; ///< s

GstClockTime
to_clock_time(Time time)
{
  return static_cast<GstClockTime>(time.count());
}

} // namespace

struct GstTactileSynthPrivate
{
  SynthSettings settings;   ///< guarded by the object lock
  GstClockTime latency = 0; ///< guarded by the object lock

  /* Set before PAUSED. */
  synth::Carriers carriers;
  SynthMotors motors;
  std::optional<tactor::CommandTrace> trace; ///< written by the streaming thread

  /* Streaming thread, or while it is stopped. */
  TactorStream stream;
  GstSegment segment;
  std::optional<GstAudioInfo> info;
  std::optional<Play> play; ///< while there is info
  guint rows = 0;           ///< of the cells of play
  guint columns = 0;
  Time last_end{ 0 };        ///< of the last map
  bool segment_sent = false; ///< the output's
  bool resync = true;        ///< the next buffer does not follow the last one

  GstTactileSynthPrivate()
  {
    gst_segment_init(&segment, GST_FORMAT_TIME);
  }
};

struct _GstTactileSynth
{
  GstElement parent;

  GstPad *sinkpad;
  GstPad *srcpad;
  GstTactileSynthPrivate *priv;
};

#define gst_tactile_synth_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileSynth, gst_tactile_synth, GST_TYPE_ELEMENT,
                        GST_DEBUG_CATEGORY_INIT(tactile_synth_debug, "tactilesynth", 0,
                                                "tactile maps as sound"));
GST_ELEMENT_REGISTER_DEFINE(tactilesynth, "tactilesynth", GST_RANK_NONE, GST_TYPE_TACTILE_SYNTH);

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(SYNTH_CAPS));

static SynthSettings
gst_tactile_synth_read_settings(GstTactileSynth *self)
{
  GST_OBJECT_LOCK(self);
  SynthSettings settings = self->priv->settings;
  GST_OBJECT_UNLOCK(self);
  return settings;
}

/* ---- output ---- */

/* Stream time of a running time. That of the segment's begin for what is before it. */
static guint64
stream_time(const GstSegment &segment, Time running)
{
  const guint64 time = std::max<guint64>(to_clock_time(running), segment.base);
  const guint64 position = gst_segment_position_from_running_time(&segment, GST_FORMAT_TIME, time);
  const guint64 found = position == GST_CLOCK_TIME_NONE
                            ? position
                            : gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, position);
  return found == GST_CLOCK_TIME_NONE ? segment.time : found;
}

/* The output's segment: its timestamps are running times. */
static void
send_segment(GstTactileSynth *self)
{
  GstTactileSynthPrivate *priv = self->priv;
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.applied_rate = priv->segment.rate * priv->segment.applied_rate;
  segment.start = segment.base = segment.position = to_clock_time(priv->play->now());
  segment.time = stream_time(priv->segment, priv->play->now());
  segment.duration = priv->segment.duration;
  if (segment.applied_rate < 0) {
    /* GStreamer counts back to `time` from `stop`, beyond which the last ramp goes. */
    const guint64 end
        = gst_segment_to_running_time(&priv->segment, GST_FORMAT_TIME, priv->segment.start);
    segment.stop = end == GST_CLOCK_TIME_NONE ? end : end + to_clock_time(Play::kRamp);
    segment.time = priv->segment.time;
  }
  gst_pad_push_event(self->srcpad, gst_event_new_segment(&segment));
  priv->segment_sent = true;
}

/* Renders and pushes a buffer of `count` samples of each channel. */
static GstFlowReturn
push_samples(GstTactileSynth *self, std::int64_t count)
{
  GstTactileSynthPrivate *priv = self->priv;
  Play &play = *priv->play;
  const Time begin = play.now();
  const gsize size = static_cast<gsize>(count) * static_cast<gsize>(priv->info->bpf);
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  const bool sounds = play.render({ reinterpret_cast<float *>(map.data), size / sizeof(float) });
  gst_buffer_unmap(buffer, &map);
  GST_BUFFER_PTS(buffer) = to_clock_time(begin);
  GST_BUFFER_DURATION(buffer) = to_clock_time(play.now() - begin);
  if (!sounds)
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_GAP);
  if (std::exchange(priv->resync, false)) {
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_RESYNC);
  }
  return gst_pad_push(self->srcpad, buffer);
}

/* Pushes all samples up to a running time. */
static GstFlowReturn
push_until(GstTactileSynth *self, Time until)
{
  GstTactileSynthPrivate *priv = self->priv;
  GstFlowReturn flow = GST_FLOW_OK;
  while (flow == GST_FLOW_OK) {
    const std::int64_t count = priv->play->count_until(until);
    if (count == 0)
      break;
    if (!priv->segment_sent)
      send_segment(self);
    const gint rate = GST_AUDIO_INFO_RATE(&*priv->info);
    if (count > std::int64_t{ kLongestSilence } * rate && priv->play->is_idle()) {
      const Time begin = priv->play->now();
      priv->play->skip(count);
      gst_pad_push_event(self->srcpad, gst_event_new_gap(to_clock_time(begin),
                                                         to_clock_time(priv->play->now() - begin)));
      priv->resync = true;
      break;
    }
    flow = push_samples(self, std::min<std::int64_t>(count, rate / kBuffersPerSecond));
  }
  return flow;
}

/* ---- negotiation ---- */

/* The cells of each channel, for a map of this grid. Tells what becomes of the cells. */
static void
set_cells(GstTactileSynth *self, const SynthSettings &settings)
{
  GstTactileSynthPrivate *priv = self->priv;
  const gint channels = GST_AUDIO_INFO_CHANNELS(&*priv->info);
  const auto count = static_cast<int>(priv->rows * priv->columns);
  synth::ChannelCells cells = synth_cells(*priv->info, priv->rows, priv->columns);
  const std::string wrong
      = tactor::CommandPlanner::validate_mapping(settings.mapping, count, channels);
  if (!settings.mapping.empty() && wrong.empty())
    cells = synth::mapped_cells(settings.mapping, channels);
  const std::string text = synth_describe(cells);
  if (!settings.mapping.empty() && !wrong.empty())
    GST_ELEMENT_WARNING(self, STREAM, FORMAT,
                        ("The mapping does not fit the film and the sound card: it is not used."),
                        ("%s; %s", wrong.c_str(), text.c_str()));
  else if (!std::ranges::all_of(cells, [](const auto &own) { return own.size() == 1; }))
    GST_ELEMENT_INFO(
        self, STREAM, FORMAT,
        ("%u x %u cells are felt on %d channels.", priv->rows, priv->columns, channels),
        ("%s", text.c_str()));
  priv->play->set_cells(std::move(cells));
}

static gint
wanted_channels(const SynthSettings &settings, guint rows, guint columns)
{
  const auto last = std::ranges::max_element(settings.mapping);
  const gint wanted
      = last == settings.mapping.end() ? static_cast<gint>(rows * columns) : *last + 1;
  return std::clamp(wanted, 1, SynthSettings::kMostChannels);
}

/* Begins to play in the format of `info`, with the sample after the last one. */
static void
start_play(GstTactileSynth *self, const GstAudioInfo &info, const SynthSettings &settings)
{
  GstTactileSynthPrivate *priv = self->priv;
  const gint channels = GST_AUDIO_INFO_CHANNELS(&info);
  const std::optional<Time> now
      = priv->play && priv->play->has_begun() ? std::optional(priv->play->now()) : std::nullopt;
  priv->play.emplace(GST_AUDIO_INFO_RATE(&info), priv->carriers.voices(channels),
                     tactor::PlannerSettings{ .max_lead = priv->motors.max_lead(),
                                              .volts_max = settings.volts_max,
                                              .volts_min = 0 },
                     priv->motors.of_channels(channels));
  priv->info = info;
  priv->play->set_soft_start(settings.ramp_in);
  if (priv->trace)
    priv->play->set_listener([priv](const tactor::Command &command, Time at) {
      priv->trace->write({ .command = command, .issued = at });
    });
  if (now)
    priv->play->begin(*now);
}

/* Agrees on the output with downstream, where that is due. */
static GstFlowReturn
negotiate(GstTactileSynth *self, const SynthSettings &settings)
{
  GstTactileSynthPrivate *priv = self->priv;
  const guint rows = priv->stream.rows();
  const guint columns = priv->stream.columns();
  const bool new_grid = rows != priv->rows || columns != priv->columns;
  if (!gst_pad_check_reconfigure(self->srcpad) && priv->play && !new_grid)
    return GST_FLOW_OK;
  const std::optional<GstAudioInfo> info
      = synth_negotiate(self->srcpad, wanted_channels(settings, rows, columns));
  if (!info) {
    gst_pad_mark_reconfigure(self->srcpad);
    if (GST_PAD_IS_FLUSHING(self->srcpad))
      return GST_FLOW_FLUSHING;
    GST_ERROR_OBJECT(self,
                     "downstream takes no sound of 1 to %d channels in " GST_AUDIO_NE(
                         F32) "; is there an audioconvert?",
                     SynthSettings::kMostChannels);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  const bool new_format = !priv->info || !gst_audio_info_is_equal(&*info, &*priv->info);
  if (new_format) {
    g_autoptr(GstCaps) caps = gst_audio_info_to_caps(&*info);
    GST_DEBUG_OBJECT(self, "caps %" GST_PTR_FORMAT, caps);
    if (!gst_pad_push_event(self->srcpad, gst_event_new_caps(caps)))
      return GST_PAD_IS_FLUSHING(self->srcpad) ? GST_FLOW_FLUSHING : GST_FLOW_NOT_NEGOTIATED;
    start_play(self, *info, settings);
  }
  priv->rows = rows;
  priv->columns = columns;
  if (new_format || new_grid)
    set_cells(self, settings);
  return GST_FLOW_OK;
}

/* ---- input ---- */

/* Sound up to a map or gap that begins at `start`: all that no other can change. */
static GstFlowReturn
advance(GstTactileSynth *self, Time start)
{
  GstTactileSynthPrivate *priv = self->priv;
  if (start - priv->last_end > kHold && priv->play->has_begun())
    priv->play->silence(priv->last_end);
  if (!priv->play->has_begun()) {
    priv->play->begin(std::max(start - priv->play->lead(), Time(0)));
    priv->resync = true;
  }
  return push_until(self, start - priv->play->lead());
}

static void
apply_settings(GstTactileSynth *self, const SynthSettings &settings)
{
  Play &play = *self->priv->play;
  play.set_intensity(settings.intensity);
  play.set_limits(settings.limits, settings.rate);
  play.set_soft_start(settings.ramp_in);
  play.set_mute(settings.mute);
}

/* Sets controlled properties for a map. */
static void
sync_values(GstTactileSynth *self, GstClockTime pts)
{
  const GstClockTime time = gst_segment_to_stream_time(&self->priv->segment, GST_FORMAT_TIME, pts);
  if (GST_CLOCK_TIME_IS_VALID(time))
    gst_object_sync_values(GST_OBJECT(self), time);
}

static GstFlowReturn
play_map(GstTactileSynth *self, GstBuffer *buffer)
{
  GstTactileSynthPrivate *priv = self->priv;
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  const GstClockTime duration = GST_BUFFER_DURATION(buffer);
  if (!priv->stream.is_shown(priv->segment, pts, duration))
    return GST_FLOW_OK;
  sync_values(self, pts);
  const SynthSettings settings = gst_tactile_synth_read_settings(self);
  if (const GstFlowReturn flow = negotiate(self, settings); flow != GST_FLOW_OK)
    return flow;
  TactorStream::Map map;
  const bool is_gap = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP);
  if (!is_gap && !priv->stream.read(buffer, map)) {
    GST_ELEMENT_ERROR(self, STREAM, FORMAT, ("A tactile map of the wrong size came."),
                      ("expected %u x %u float32 levels, got %" G_GSIZE_FORMAT " bytes", priv->rows,
                       priv->columns, gst_buffer_get_size(buffer)));
    return GST_FLOW_ERROR;
  }
  const TactorStream::Span shown = priv->stream.shown(priv->segment, pts, duration, priv->last_end);
  if (const GstFlowReturn flow = advance(self, shown.start); flow != GST_FLOW_OK)
    return flow;
  apply_settings(self, settings);
  if (is_gap)
    priv->play->silence(shown.start);
  else
    priv->play->plan(shown.start, shown.duration, map.levels);
  priv->last_end = shown.end();
  return push_until(self, shown.end() - priv->play->lead());
}

static GstFlowReturn
gst_tactile_synth_chain(GstPad *, GstObject *parent, GstBuffer *buffer)
{
  auto *self = GST_TACTILE_SYNTH(parent);
  const GstFlowReturn flow
      = self->priv->stream.is_map() ? play_map(self, buffer) : GST_FLOW_NOT_NEGOTIATED;
  gst_buffer_unref(buffer);
  return flow;
}

static void
play_gap(GstTactileSynth *self, GstEvent *event)
{
  GstTactileSynthPrivate *priv = self->priv;
  GstClockTime pts = 0;
  GstClockTime duration = 0;
  gst_event_parse_gap(event, &pts, &duration);
  if (!priv->stream.is_map() || !priv->stream.is_shown(priv->segment, pts, duration)
      || negotiate(self, gst_tactile_synth_read_settings(self)) != GST_FLOW_OK)
    return;
  const TactorStream::Span shown = priv->stream.shown(priv->segment, pts, duration, priv->last_end);
  if (advance(self, shown.start) != GST_FLOW_OK)
    return;
  priv->play->silence(shown.start);
  priv->last_end = shown.end();
  push_until(self, shown.end() - priv->play->lead());
}

/* The rest of the sound, down to silence at the end of the last map. */
static void
drain(GstTactileSynth *self)
{
  GstTactileSynthPrivate *priv = self->priv;
  if (!priv->play || !priv->play->has_begun())
    return;
  priv->play->silence(priv->last_end);
  push_until(self, priv->last_end + Play::kRamp);
}

static void
flush(GstTactileSynth *self, GstEvent *event)
{
  GstTactileSynthPrivate *priv = self->priv;
  gboolean resets_time = FALSE;
  gst_event_parse_flush_stop(event, &resets_time);
  if (priv->play && priv->play->has_begun())
    priv->play->flush(resets_time);
  priv->last_end = Time(0);
  priv->segment_sent = false;
  gst_segment_init(&priv->segment, GST_FORMAT_TIME);
}

static gboolean
gst_tactile_synth_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  auto *self = GST_TACTILE_SYNTH(parent);
  GstTactileSynthPrivate *priv = self->priv;

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_CAPS: {
    GstCaps *caps = nullptr;
    gst_event_parse_caps(event, &caps);
    const gboolean is_set = priv->stream.set_caps(caps);
    gst_event_unref(event);
    return is_set;
  }
  case GST_EVENT_SEGMENT:
    gst_event_copy_segment(event, &priv->segment);
    priv->segment_sent = false; /* sent before the next samples */
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_GAP:
    play_gap(self, event);
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_TAG: /* what is about the maps is not about the sound */
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_EOS:
  case GST_EVENT_SEGMENT_DONE:
    drain(self);
    break;
  case GST_EVENT_FLUSH_STOP:
    flush(self, event);
    break;
  default:
    break;
  }
  return gst_pad_event_default(pad, parent, event);
}

static gboolean
gst_tactile_synth_src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  if (!gst_pad_query_default(pad, parent, query))
    return FALSE;
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY) {
    gboolean live = FALSE;
    GstClockTime min = 0;
    GstClockTime max = 0;
    gst_query_parse_latency(query, &live, &min, &max);
    GST_OBJECT_LOCK(parent);
    const GstClockTime latency = GST_TACTILE_SYNTH(parent)->priv->latency;
    GST_OBJECT_UNLOCK(parent);
    gst_query_set_latency(query, live, min + latency,
                          GST_CLOCK_TIME_IS_VALID(max) ? max + latency : max);
  }
  return TRUE;
}

/* ---- state ---- */

/* READY to PAUSED: reads files. False after an error message. */
static bool
prepare(GstTactileSynth *self)
{
  GstTactileSynthPrivate *priv = self->priv;
  const SynthSettings settings = gst_tactile_synth_read_settings(self);
  if (!settings.faults.empty()) {
    const auto &[property, why] = *settings.faults.begin();
    GST_ELEMENT_ERROR(self, LIBRARY, SETTINGS,
                      ("%s cannot be read: %s.", property.c_str(), why.c_str()), (nullptr));
    return false;
  }
  priv->carriers = settings.carriers;
  const auto &waveforms = settings.carriers.waveforms;
  if (std::ranges::find(waveforms, synth::Waveform::sample) != waveforms.end()) {
    const auto sample = synth::read_wave_file(settings.sample);
    if (!sample) {
      GST_ELEMENT_ERROR(self, RESOURCE, READ, ("%s.", sample.error().c_str()),
                        ("waveform=sample repeats the file of the property sample"));
      return false;
    }
    priv->carriers.sample = *sample;
  }
  tl::expected<SynthMotors, std::string> motors = SynthMotors::read(settings);
  if (!motors) {
    GST_ELEMENT_ERROR(self, RESOURCE, READ, ("%s.", motors.error().c_str()), (nullptr));
    return false;
  }
  priv->motors = std::move(*motors);
  if (!settings.trace_location.empty()) {
    tl::expected<tactor::CommandTrace, tactor::DriverError> trace
        = tactor::CommandTrace::create(settings.trace_location);
    if (!trace) {
      GST_ELEMENT_ERROR(self, RESOURCE, OPEN_WRITE, ("%s.", trace.error().text.c_str()), (nullptr));
      return false;
    }
    priv->trace.emplace(std::move(*trace));
  }
  GST_OBJECT_LOCK(self);
  priv->latency = to_clock_time(priv->motors.lead());
  GST_OBJECT_UNLOCK(self);
  return true;
}

static void
reset(GstTactileSynth *self)
{
  GstTactileSynthPrivate *priv = self->priv;
  priv->stream = {};
  gst_segment_init(&priv->segment, GST_FORMAT_TIME);
  priv->info.reset();
  priv->play.reset();
  if (priv->trace) {
    priv->trace->flush();
    if (priv->trace->failed())
      GST_ELEMENT_WARNING(self, RESOURCE, WRITE, ("The command trace is incomplete."),
                          ("writing to it failed: is the disk full?"));
    priv->trace.reset();
  }
  priv->rows = priv->columns = 0;
  priv->last_end = Time(0);
  priv->segment_sent = false;
  priv->resync = true;
}

static GstStateChangeReturn
gst_tactile_synth_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_TACTILE_SYNTH(element);
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !prepare(self))
    return GST_STATE_CHANGE_FAILURE;
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    reset(self);
  return result;
}

static SynthSettings &
gst_tactile_synth_settings(GObject *object)
{
  return GST_TACTILE_SYNTH(object)->priv->settings;
}

static void
gst_tactile_synth_finalize(GObject *object)
{
  delete GST_TACTILE_SYNTH(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_synth_class_init(GstTactileSynthClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);

  object_class->finalize = gst_tactile_synth_finalize;
  properties::install<SynthSettings>(object_class, SynthSettings::table(),
                                     { gst_tactile_synth_settings });
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactile_synth_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(element_class, "Tactile synthesizer", "Converter/Tactile",
                                        "Turns tactile maps into sound for shakers",
                                        "The visuotactile authors");
}

static void
gst_tactile_synth_init(GstTactileSynth *self)
{
  self->priv = new GstTactileSynthPrivate;
  self->sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_synth_chain));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_synth_sink_event));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_tactile_synth_src_query));
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);
}
