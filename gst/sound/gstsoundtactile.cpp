// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-soundtactile
 * @title: soundtactile
 * @short_description: makes tactile maps of sound: blows and rumble are felt, voices are not
 *
 * soundtactile passes audio through, untouched, and sends what is felt of it as a stream of tactile
 * maps on its `tactile` pad, #GstSoundTactile:maps-per-second of them. The grid is what downstream
 * asks for, else 3 × 3.
 *
 * ## What is felt
 * - Blows and explosions: what fills all frequencies with noise at once, down to the lowest. Notes
 *   and voices do not. Felt as strong as what is louder than just before, while it lasts.
 * - Rumble: what stands out below 65 Hz: a large part of the sound, or an LFE channel's, and louder
 *   than in the seconds before. An engine that goes on fades within half a minute.
 *
 * ## Where
 * Left and right are columns. Where there are loudspeakers behind the audience, the front is the
 * top rows and what is behind the bottom rows; else all rows are alike. The center, which carries
 * voices, tells no place. Low frequency effects, mono and sounds that differ between left and
 * right are felt everywhere.
 *
 * ## Time
 * A map is known once the sound 10.6 ms after its end is in (at 48 kHz). With the map's own length
 * that is the latency of the `tactile` pad; `src` has none. Put a queue on each branch, as behind a
 * demuxer. Played backwards, the `tactile` pad has gaps. So has audio that is not read: of more
 * than 8 channels, or below 8 or above 192 kHz.
 *
 * By default tactorsink takes a map every 200 ms, which misses most blows: set its `rate` to 0.
 *
 * `pipelines/sound.sh FILM` plays a film whose picture and sound are both felt.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactilesoundtestsrc num-buffers=200 ! soundtactile name=s \
 *     s.src ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=400000000 ! audioconvert ! \
 *     autoaudiosink s.tactile ! queue ! tactorsink rate=0
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! queue ! \
 *     tactilecombiner name=c mix=max ! tactileoverlay ! videoconvert ! autovideosink \
 *     tactilesoundtestsrc num-buffers=235 ! soundtactile name=s \
 *     s.src ! queue ! audioconvert ! autoaudiosink s.tactile ! queue ! c.tactile
 * ]|
 *
 * Since: 0.1
 */
#include "gstsoundtactile.h"

#include "../properties.h"
#include "../tactile/wantedgrid.h"
#include "gstsoundelements.h"
#include "soundreader.h"

#include <gst/audio/audio.h>
#include <gst/base/gstflowcombiner.h>
#include <gst/tactile/tactile.h>

GST_DEBUG_CATEGORY_STATIC(sound_tactile_debug);
#define GST_CAT_DEFAULT sound_tactile_debug

namespace {

using Settings = SoundReader::Settings;

struct Private
{
  Settings settings;        ///< guarded by the object lock
  GstClockTime latency = 0; ///< of the tactile pad; guarded by the object lock

  // Streaming thread, or while it is stopped.
  GstFlowCombiner *combiner = gst_flow_combiner_new();
  SoundReader reader;
  Settings used;        ///< for this buffer
  GstSegment segment{}; ///< of the audio
  bool is_read = false; ///< the format is one that can be read
  guint rows = 0;       ///< of the tactile pad's caps; 0: none sent yet
  guint columns = 0;
  GstEvent *pending_segment = nullptr; ///< for the tactile pad, which needs caps first
  bool discont = false;                ///< of the next map
  GstFlowReturn flow = GST_FLOW_OK;    ///< of the tactile pad
};

} // namespace

struct _GstSoundTactile
{
  GstElement parent;

  GstPad *sinkpad;
  GstPad *srcpad;
  GstPad *tactilepad;
  Private *priv;
};

#define gst_sound_tactile_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstSoundTactile, gst_sound_tactile, GST_TYPE_ELEMENT,
                        GST_DEBUG_CATEGORY_INIT(sound_tactile_debug, "soundtactile", 0,
                                                "what is felt of sound"));
GST_ELEMENT_REGISTER_DEFINE(soundtactile, "soundtactile", GST_RANK_NONE, GST_TYPE_SOUND_TACTILE);

#define AUDIO_CAPS "audio/x-raw, layout = (string) { interleaved, non-interleaved }"

static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(AUDIO_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(AUDIO_CAPS));
static GstStaticPadTemplate tactile_template = GST_STATIC_PAD_TEMPLATE(
    "tactile", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));

/* ---- the tactile pad ---- */

/* Sends caps, then a segment, if they are still to be sent. */
static void
send_sticky_events(GstSoundTactile *self)
{
  Private *priv = self->priv;
  if (priv->rows == 0) {
    wanted_grid(self->tactilepad, &priv->rows, &priv->columns);
    GstCaps *caps = gst_tactile_map_caps_new(priv->rows, priv->columns,
                                             static_cast<gint>(priv->used.maps_per_second), 1);
    GST_DEBUG_OBJECT(self->tactilepad, "caps %" GST_PTR_FORMAT, caps);
    gst_pad_push_event(self->tactilepad, gst_event_new_caps(caps));
    gst_caps_unref(caps);
  }
  if (priv->pending_segment != nullptr) {
    gst_pad_push_event(self->tactilepad, priv->pending_segment);
    priv->pending_segment = nullptr;
  }
}

/* A branch that was unlinked during a push returns FLUSHING. That must not end the other branch. */
static GstFlowReturn
push(GstPad *pad, GstBuffer *buffer)
{
  const GstFlowReturn flow = gst_pad_push(pad, buffer);
  return flow == GST_FLOW_FLUSHING && !gst_pad_is_linked(pad) ? GST_FLOW_NOT_LINKED : flow;
}

static SoundReader::MapSink
map_sink(GstSoundTactile *self)
{
  return [self](const tactile::TactileMap &map, GstClockTime begin, GstClockTime end) {
    GstBuffer *buffer = gst_tactile_map_buffer_new(map.levels.data(), map.levels.size());
    GST_BUFFER_PTS(buffer) = begin;
    GST_BUFFER_DURATION(buffer) = end - begin;
    if (self->priv->discont)
      GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
    self->priv->discont = false;
    send_sticky_events(self);
    self->priv->flow = push(self->tactilepad, buffer);
  };
}

static void
drain(GstSoundTactile *self)
{
  self->priv->reader.drain(self->priv->used, map_sink(self));
  self->priv->discont = true;
}

static GstFlowReturn
push_tactile(GstSoundTactile *self, GstBuffer *buffer)
{
  Private *priv = self->priv;
  const GstClockTime pts = GST_BUFFER_PTS(buffer);

  GST_OBJECT_LOCK(self);
  priv->used.feel = priv->settings.feel;
  GST_OBJECT_UNLOCK(self);
  priv->flow = gst_pad_is_linked(self->tactilepad) ? GST_FLOW_OK : GST_FLOW_NOT_LINKED;
  if (!GST_CLOCK_TIME_IS_VALID(pts))
    return priv->flow;
  if (!priv->is_read || priv->segment.rate < 0) {
    send_sticky_events(self);
    gst_pad_push_event(self->tactilepad, gst_event_new_gap(pts, GST_BUFFER_DURATION(buffer)));
    return priv->flow;
  }
  priv->reader.read(buffer, priv->used, map_sink(self));
  return priv->flow;
}

static GstFlowReturn
gst_sound_tactile_chain(GstPad *pad, GstObject *parent, GstBuffer *buffer)
{
  (void)pad;
  auto *self = GST_SOUND_TACTILE(parent);

  /* The maps first: tactors are needed earlier than loudspeakers. */
  GstFlowReturn flow = push_tactile(self, buffer);
  gst_flow_combiner_update_pad_flow(self->priv->combiner, self->tactilepad, flow);
  flow = push(self->srcpad, buffer);
  return gst_flow_combiner_update_pad_flow(self->priv->combiner, self->srcpad, flow);
}

/* ---- events ---- */

static void
send_stream_start(GstSoundTactile *self, GstEvent *audio)
{
  const gchar *audio_id = nullptr;
  gst_event_parse_stream_start(audio, &audio_id);
  gchar *id = g_strconcat(audio_id, "/tactile", nullptr);
  GstEvent *event = gst_event_new_stream_start(id);
  g_free(id);

  guint group = GST_GROUP_ID_INVALID;
  if (gst_event_parse_group_id(audio, &group))
    gst_event_set_group_id(event, group);
  gst_event_set_seqnum(event, gst_event_get_seqnum(audio));
  gst_pad_push_event(self->tactilepad, event);
}

static void
read_caps(GstSoundTactile *self, GstEvent *event)
{
  Private *priv = self->priv;
  GstCaps *caps = nullptr;
  gst_event_parse_caps(event, &caps);
  drain(self);
  send_sticky_events(self);
  GstAudioInfo info;
  priv->is_read = gst_audio_info_from_caps(&info, caps)
                  && priv->reader.set_format(info, static_cast<int>(priv->rows),
                                             static_cast<int>(priv->columns));
  if (!priv->is_read)
    GST_ELEMENT_WARNING(self, STREAM, FORMAT, ("Nothing of this sound is felt."),
                        ("expected 1 to %d channels at %d to %d Hz, got %" GST_PTR_FORMAT
                         "; put audioconvert and audioresample before this element",
                         sound::kMaxSpeakers, sound::SoundAnalyzer::kLowestRate,
                         sound::SoundAnalyzer::kHighestRate, caps));
  const GstClockTime latency = priv->reader.latency(priv->used.maps_per_second);
  GST_OBJECT_LOCK(self);
  const bool changed = latency != priv->latency;
  priv->latency = latency;
  GST_OBJECT_UNLOCK(self);
  if (changed)
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_latency(GST_OBJECT(self)));
}

/* Serialized events come after the maps of what came before them. Events about audio (caps, tags)
 * go to the audio only. */
static gboolean
gst_sound_tactile_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  (void)pad;
  auto *self = GST_SOUND_TACTILE(parent);
  Private *priv = self->priv;
  gboolean handled = FALSE; /* by the tactile branch: then audio may be unlinked */

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_STREAM_START:
    send_stream_start(self, event);
    break;
  case GST_EVENT_CAPS:
    read_caps(self, event);
    break;
  case GST_EVENT_SEGMENT:
    drain(self);
    gst_event_copy_segment(event, &priv->segment);
    if (priv->rows > 0)
      gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    else
      gst_event_replace(&priv->pending_segment, event);
    break;
  case GST_EVENT_GAP:
  case GST_EVENT_SEGMENT_DONE:
  case GST_EVENT_EOS:
    drain(self);
    send_sticky_events(self);
    handled = gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    break;
  case GST_EVENT_STREAM_GROUP_DONE:
  case GST_EVENT_INSTANT_RATE_CHANGE:
  case GST_EVENT_FLUSH_START:
    handled = gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    break;
  case GST_EVENT_FLUSH_STOP:
    gst_flow_combiner_reset(priv->combiner);
    gst_clear_event(&priv->pending_segment);
    priv->reader.reset();
    handled = gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    break;
  default:
    break;
  }
  return gst_pad_push_event(self->srcpad, event) || handled;
}

static gboolean
gst_sound_tactile_tactile_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_QOS:         /* late tactors are no reason to drop sound */
  case GST_EVENT_RECONFIGURE: /* nor a new tactile branch one to negotiate it again */
    gst_event_unref(event);
    return TRUE;
  default:
    return gst_pad_event_default(pad, parent, event);
  }
}

/* ---- queries ---- */

/* Audio passes through: caps of both sides are the same. */
static gboolean
proxy_caps_query(GstPad *pad, GstPad *other, GstQuery *query)
{
  GstCaps *filter = nullptr;
  gst_query_parse_caps(query, &filter);
  GstCaps *own = gst_pad_get_pad_template_caps(pad);
  GstCaps *peer = gst_pad_peer_query_caps(other, filter);
  GstCaps *result = gst_caps_intersect_full(peer, own, GST_CAPS_INTERSECT_FIRST);
  gst_query_set_caps_result(query, result);
  gst_caps_unref(result);
  gst_caps_unref(peer);
  gst_caps_unref(own);
  return TRUE;
}

static gboolean
gst_sound_tactile_sink_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_SOUND_TACTILE(parent);

  switch (GST_QUERY_TYPE(query)) {
  case GST_QUERY_CAPS:
    return proxy_caps_query(pad, self->srcpad, query);
  case GST_QUERY_ACCEPT_CAPS:
    if (!gst_pad_is_linked(self->srcpad))
      return gst_pad_query_default(pad, parent, query);
    return gst_pad_peer_query(self->srcpad, query);
  case GST_QUERY_ALLOCATION:
    return gst_pad_peer_query(self->srcpad, query);
  default:
    return gst_pad_query_default(pad, parent, query);
  }
}

static gboolean
gst_sound_tactile_src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS)
    return proxy_caps_query(pad, GST_SOUND_TACTILE(parent)->sinkpad, query);
  return gst_pad_query_default(pad, parent, query);
}

static gboolean
gst_sound_tactile_tactile_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_SOUND_TACTILE(parent);
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
    return gst_pad_query_default(pad, parent, query);
  if (!gst_pad_peer_query(self->sinkpad, query))
    return FALSE;
  gboolean live = FALSE;
  GstClockTime min = 0;
  GstClockTime max = GST_CLOCK_TIME_NONE;
  gst_query_parse_latency(query, &live, &min, &max);
  GST_OBJECT_LOCK(self);
  const GstClockTime own = self->priv->latency;
  GST_OBJECT_UNLOCK(self);
  if (GST_CLOCK_TIME_IS_VALID(max))
    max += own;
  gst_query_set_latency(query, live, min + own, max);
  return TRUE;
}

/* ---- the element ---- */

static void
start(GstSoundTactile *self)
{
  GST_OBJECT_LOCK(self);
  self->priv->used = self->priv->settings;
  GST_OBJECT_UNLOCK(self);
}

static void
stop(GstSoundTactile *self)
{
  Private *priv = self->priv;
  gst_flow_combiner_reset(priv->combiner);
  gst_clear_event(&priv->pending_segment);
  priv->reader.reset();
  priv->rows = priv->columns = 0;
  priv->is_read = false;
  priv->discont = false;
  gst_segment_init(&priv->segment, GST_FORMAT_TIME);
}

static GstStateChangeReturn
gst_sound_tactile_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_SOUND_TACTILE(element);
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED)
    start(self);
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    stop(self);
  return result;
}

using P = properties::Property<Settings>;
static constexpr P kProperties[] = {
  P::number<guint>("maps-per-second", "Maps a second on the tactile pad", properties::kReady,
                   PROPERTY_FIELD(maps_per_second), P::Range{ 10, 200 }),
  P::number<gdouble>("gain", "Added to every sound before its level, in dB",
                     properties::kControllable, PROPERTY_FIELD(feel.gain_db), P::Range{ -40, 40 }),
  P::flag("blows", "Whether blows and explosions are felt", properties::kPlaying,
          PROPERTY_FIELD(feel.blows)),
  P::flag("rumble", "Whether what goes on below 65 Hz is felt", properties::kPlaying,
          PROPERTY_FIELD(feel.rumble)),
};

static Settings &
gst_sound_tactile_settings(GObject *object)
{
  return GST_SOUND_TACTILE(object)->priv->settings;
}

static void
gst_sound_tactile_finalize(GObject *object)
{
  Private *priv = GST_SOUND_TACTILE(object)->priv;
  gst_clear_event(&priv->pending_segment);
  gst_flow_combiner_unref(priv->combiner);
  delete priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_sound_tactile_class_init(GstSoundTactileClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);

  object_class->finalize = gst_sound_tactile_finalize;
  properties::install<Settings>(object_class, kProperties, { gst_sound_tactile_settings });
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_sound_tactile_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_add_static_pad_template(element_class, &tactile_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile sound analysis", "Filter/Analyzer/Audio",
      "Passes audio through and makes tactile maps of its blows and rumble, not of voices",
      "The visuotactile authors");
}

static void
gst_sound_tactile_init(GstSoundTactile *self)
{
  self->priv = new Private;
  gst_segment_init(&self->priv->segment, GST_FORMAT_TIME);

  self->sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_sound_tactile_chain));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_sound_tactile_sink_event));
  gst_pad_set_query_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_sound_tactile_sink_query));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_sound_tactile_src_query));
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);

  self->tactilepad = gst_pad_new_from_static_template(&tactile_template, "tactile");
  gst_pad_set_event_function(self->tactilepad, GST_DEBUG_FUNCPTR(gst_sound_tactile_tactile_event));
  gst_pad_set_query_function(self->tactilepad, GST_DEBUG_FUNCPTR(gst_sound_tactile_tactile_query));
  gst_pad_use_fixed_caps(self->tactilepad);
  gst_element_add_pad(GST_ELEMENT(self), self->tactilepad);

  gst_flow_combiner_add_pad(self->priv->combiner, self->srcpad);
  gst_flow_combiner_add_pad(self->priv->combiner, self->tactilepad);
}
