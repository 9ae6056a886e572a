// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactilesynth
 * @title: tactilesynth
 * @short_description: converts tactile maps to sound, for shakers and voice coils
 *
 * tactilesynth converts a stream of tactile maps to sound for bass shakers, exciters and voice
 * coils at an amplifier. Each channel is a carrier with the level of its cells as amplitude. Any
 * audio sink plays it on the pipeline clock. [tactoraudiosink](tactoraudiosink.md) includes a
 * sink; [shakers](../hardware/shakers.md) describes the hardware.
 *
 * - Time stamps are running times, without drift. At rates other than 1 and in reverse, carriers
 *   keep their frequency.
 * - An amplitude changes within 12 ms, half of it before the time of the change. Sidebands more
 *   than 200 Hz from the carrier are below -60 dB of full scale.
 * - Carriers continue in silence, so that their phase depends on time only. The frequency of a map
 *   replaces that of a sine, with the equalizer's gain there; other carriers keep theirs.
 * - No sample exceeds full scale. If gain and equalizer of a #GstTactilesynth:calibration would
 *   exceed it, the element limits the amplitude, so that the carrier keeps its shape.
 *
 * ## Channels
 * The caps of downstream determine the channels. Without a restriction, there is one channel for
 * each cell, or those that #GstTactilesynth:mapping names.
 * - Channels without positions (`channel-mask=(bitmask)0x0`), at least as many as cells: cell i is
 *   channel i. With fewer channels, each plays the strongest cell of its columns; a column between
 *   two channels is on both.
 * - Channels with positions: back and side channels play, side by side, and LFE plays all cells.
 *   If there are none of these, the front channels play. Other channels are silent.
 *
 * If a channel is silent or has several cells, the element posts an information message. Before
 * `audioconvert`, set the number of channels, as in the first line below: audioconvert drops
 * channels without positions that a sound card lacks.
 *
 * #GstTactilesynth:frequency, #GstTactilesynth:waveform, #GstTactilesynth:sample and
 * #GstTactilesynth:gain have one entry for each channel. A calibration has a [gain in dB and an
 * equalizer](../guide/calibration.md#gain-and-equalizer) for each; the equalizer filters the
 * carrier, not its changes.
 *
 * ## Rise time
 * A shaker needs time to vibrate, as a coin motor does. The element makes each change early, so
 * that 90 % of the level are reached with its frame. #GstTactilesynth:rise-time is an estimate: a
 * resonator of quality Q, driven at its resonance f, takes ln(10) Q / (π f), which is 24 ms with Q
 * = 2 at 60 Hz. A shaker bolted to a heavy seat takes longer, a voice coil in the hand less. A
 * #GstTactilesynth:calibration has measured values and makes channels equally strong.
 *
 * The sound of a time depends on the maps up to one rise time and 6 ms later. For live sources
 * this is latency, by which the pipeline delays all sinks. Otherwise, put a queue that holds more
 * than that before each sink, as in the launch lines. Changes in this first interval after a start
 * or a seek are late.
 *
 * ## Limits
 * The limits and defaults are those of tactorsink: #GstTactilesynth:max-on-time,
 * #GstTactilesynth:max-duty, #GstTactilesynth:max-active and a soft start. A map holds until the
 * next one, for one second at most. #GstTactilesynth:mute and the end of a cue take effect after
 * the buffer of the sink, 200 ms by default.
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

#include "../gaps.h"
#include "../latency.h"
#include "../tactor/tactorstream.h"
#include "synthcaps.h"
#include "synthoutput.h"
#include "synthparts.h"
#include "synthsettings.h"

#include <gst/tactile/tactile.h>

#include <algorithm>

using synth::Play;
using synth::Time;

GST_DEBUG_CATEGORY(tactile_synth_debug);
#define GST_CAT_DEFAULT tactile_synth_debug

struct GstTactileSynthPrivate
{
  SynthSettings settings;   ///< guarded by the object lock
  GstClockTime latency = 0; ///< guarded by the object lock

  SynthParts parts; ///< opened before PAUSED

  /* Streaming thread, or while it is stopped. */
  TactorStream stream;
  SynthOutput output;
  Time last_end{ 0 }; ///< of the last map

  GstTactileSynthPrivate(GstElement *element, GstPad *srcpad)
      : output(element, srcpad, parts, [this, element] {
          GST_OBJECT_LOCK(element);
          const bool silent = settings.is_silent();
          GST_OBJECT_UNLOCK(element);
          return silent;
        })
  {
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

/* ---- input ---- */

/* Sound up to a map or gap that begins at `start`: all that no other can change. */
static GstFlowReturn
advance(GstTactileSynthPrivate *priv, Time start)
{
  Play &play = *priv->output.play();
  if (start - priv->last_end > TactorStream::kHold && play.has_begun())
    play.silence(priv->last_end);
  if (!play.has_begun())
    priv->output.begin(std::max(start - play.lead(), Time(0)));
  return priv->output.push_until(start - play.lead());
}

static void
apply_settings(Play &play, const SynthSettings &settings)
{
  play.set_intensity(settings.intensity);
  play.set_limits(settings.limits, settings.rate);
  play.set_soft_start(settings.ramp_in);
}

static GstFlowReturn
play_map(GstTactileSynth *self, GstBuffer *buffer)
{
  GstTactileSynthPrivate *priv = self->priv;
  const GstSegment &segment = priv->output.segment();
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  const GstClockTime duration = GST_BUFFER_DURATION(buffer);
  if (!priv->stream.is_shown(segment, pts, duration))
    return GST_FLOW_OK;
  properties::sync_values(self, segment, pts);
  const SynthSettings settings = gst_tactile_synth_read_settings(self);
  const guint rows = priv->stream.rows();
  const guint columns = priv->stream.columns();
  if (const GstFlowReturn flow = priv->output.negotiate(settings, rows, columns);
      flow != GST_FLOW_OK)
    return flow;
  TactorStream::Map map;
  const bool is_gap = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP);
  if (!is_gap && !priv->stream.read(buffer, map)) {
    GST_ELEMENT_ERROR(self, STREAM, FORMAT, ("A tactile map has the wrong size."),
                      ("expected %u x %u float32 levels, got %" G_GSIZE_FORMAT " bytes", rows,
                       columns, gst_buffer_get_size(buffer)));
    return GST_FLOW_ERROR;
  }
  const TactorStream::Span shown = priv->stream.shown(segment, pts, duration, priv->last_end);
  if (const GstFlowReturn flow = advance(priv, shown.start); flow != GST_FLOW_OK)
    return flow;
  Play &play = *priv->output.play();
  apply_settings(play, settings);
  if (is_gap)
    play.silence(shown.start);
  else
    play.plan(shown.start, shown.duration, map.levels,
              static_cast<double>(gst_buffer_get_tactile_frequency(buffer)));
  priv->last_end = shown.end();
  return priv->output.push_until(shown.end() - play.lead());
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
  const GstSegment &segment = priv->output.segment();
  GstClockTime pts = 0;
  GstClockTime duration = 0;
  gst_event_parse_gap(event, &pts, &duration);
  if (!priv->stream.is_map() || !priv->stream.is_shown(segment, pts, duration)
      || priv->output.negotiate(gst_tactile_synth_read_settings(self), priv->stream.rows(),
                                priv->stream.columns())
             != GST_FLOW_OK)
    return;
  const TactorStream::Span shown = priv->stream.shown(segment, pts, duration, priv->last_end);
  if (advance(priv, shown.start) != GST_FLOW_OK)
    return;
  Play &play = *priv->output.play();
  play.silence(shown.start);
  priv->last_end = shown.end();
  priv->output.push_until(shown.end() - play.lead());
}

/* The rest of the sound, down to silence at the end of the last map. */
static void
drain(GstTactileSynthPrivate *priv)
{
  Play *play = priv->output.play();
  if (!play || !play->has_begun())
    return;
  play->silence(priv->last_end);
  priv->output.push_until(priv->last_end + Play::kRamp);
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
  case GST_EVENT_SEGMENT: {
    const GstSegment *segment = nullptr;
    gst_event_parse_segment(event, &segment);
    priv->output.set_segment(*segment, gst_event_get_seqnum(event));
    gst_event_unref(event);
    return TRUE;
  }
  case GST_EVENT_GAP:
    if (!is_loss(event))
      play_gap(self, event);
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_TAG: /* what is about the maps is not about the sound */
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_EOS:
  case GST_EVENT_SEGMENT_DONE:
    drain(priv);
    break;
  case GST_EVENT_FLUSH_STOP: {
    gboolean resets_time = FALSE;
    gst_event_parse_flush_stop(event, &resets_time);
    priv->output.flush(resets_time);
    priv->last_end = Time(0);
    break;
  }
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
    GST_OBJECT_LOCK(parent);
    const GstClockTime own = GST_TACTILE_SYNTH(parent)->priv->latency;
    GST_OBJECT_UNLOCK(parent);
    latency::add(query, own);
  }
  return TRUE;
}

/* ---- state ---- */

/* READY to PAUSED. False after an error message. */
static bool
prepare(GstTactileSynth *self)
{
  GstTactileSynthPrivate *priv = self->priv;
  if (!priv->parts.open(GST_ELEMENT(self), gst_tactile_synth_read_settings(self)))
    return false;
  GST_OBJECT_LOCK(self);
  priv->latency = static_cast<GstClockTime>(priv->parts.motors.lead().count());
  GST_OBJECT_UNLOCK(self);
  return true;
}

static GstStateChangeReturn
gst_tactile_synth_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_TACTILE_SYNTH(element);
  GstTactileSynthPrivate *priv = self->priv;
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !prepare(self))
    return GST_STATE_CHANGE_FAILURE;
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
    priv->stream = {};
    priv->output.reset();
    priv->parts.close(element);
    priv->last_end = Time(0);
  }
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
  self->sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_synth_chain));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_synth_sink_event));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_tactile_synth_src_query));
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);

  self->priv = new GstTactileSynthPrivate(GST_ELEMENT(self), self->srcpad);
}
