// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-soundtactile
 * @title: soundtactile
 * @short_description: makes tactile maps of sound: impacts and rumble are felt, voices are not
 *
 * soundtactile passes audio through, untouched, and sends what is felt of it as a stream of tactile
 * maps on its `tactile` pad, #GstSoundTactile:maps-per-second of them. The grid is the one of the
 * caps downstream, else 3 × 3.
 *
 * ## What is felt
 * - Impacts: explosions, blows, shots, doors, footsteps, as the detector learned them from real
 *   sounds, and not notes, drums and voices. Felt as strong as what is louder than just before,
 *   while it lasts, against how loud the film is.
 * - Rumble: what below 65 Hz is like engines and thunder, and not like the bass of music, or comes
 *   from an LFE channel, and is louder than in the seconds before. An engine that goes on fades
 *   within half a minute.
 *
 * ## Where
 * Left and right are columns. Where there are loudspeakers behind the audience, the front is the
 * top rows and what is behind the bottom rows; else all rows are alike. The center, which carries
 * voices, has no place. Low frequency effects, mono and sounds that differ between left and
 * right are felt everywhere.
 *
 * ## Frequency
 * Maps have the sound's own frequency from 20 to 130 Hz, or up to 300 Hz where it has no bass, for
 * actuators that have a choice.
 *
 * ## Time
 * A map is known once the sound 10.6 ms after its end is in (at 48 kHz). With the map's own length
 * that is the latency of the `tactile` pad; `src` has none. Put a queue on each branch, as behind a
 * demuxer. Played backwards, the `tactile` pad has gaps. So has audio that is not read: of more
 * than 8 channels, or below 8 or above 192 kHz.
 *
 * ## With the picture
 * Where nothing is linked to `tactile` and a visuotactilesink or a visuotactiledecoder plays in the
 * same pipeline, as with `playbin audio-filter=soundtactile`, the maps join those of the picture.
 * Their `sound` then says what is felt, and 480 ms of sound wait here unless the source is live. In
 * them, impacts differ more from music.
 * More is in [Sound joins in](../guide/sound.md).
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactilesoundtestsrc num-buffers=200 ! soundtactile name=s \
 *     s.src ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=400000000 ! audioconvert ! \
 *     autoaudiosink s.tactile ! queue ! tactorsink
 * gst-launch-1.0 playbin uri=file://FILM audio-filter=soundtactile video-sink=visuotactilesink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! queue ! \
 *     tactilecombiner name=c mix=max ! tactileoverlay ! videoconvert ! autovideosink \
 *     tactilesoundtestsrc num-buffers=235 ! soundtactile name=s \
 *     s.src ! queue ! audioconvert ! autoaudiosink s.tactile ! queue ! c.tactile
 * ]|
 *
 * Since: 0.1
 */
#include "gstsoundtactile.h"

#include "../heldstream.h"
#include "../latency.h"
#include "../properties.h"
#include "../runningtime.h"
#include "../tactile/splitpads.h"
#include "gst/fusion/pipeline_sound.h"
#include "gst/fusion/sound_meta.h"
#include "gstsoundelements.h"
#include "soundreader.h"

#include <gst/audio/audio.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <memory>
#include <utility>

GST_DEBUG_CATEGORY_STATIC(sound_tactile_debug);
#define GST_CAT_DEFAULT sound_tactile_debug

namespace {

using Settings = SoundReader::Settings;

/// How much sound that a chair beside it feels waits behind the analysis: the chair needs its maps
/// 190 ms before they are heard and two frames ahead, and sinks take sound no earlier than they
/// have to. The analysis looks 100 ms ahead.
constexpr GstClockTime kAhead = 480 * GST_MSECOND;

struct Private
{
  explicit Private(HeldStream::Ways ways) : held(std::move(ways))
  {
  }

  Settings settings;        ///< guarded by the object lock
  GstClockTime latency = 0; ///< of the tactile pad; guarded by the object lock

  std::shared_ptr<fusion::SoundMaps> maps; ///< from PAUSED on; changes with the state

  // Streaming thread, or while it is stopped.
  SplitPads *pads = nullptr;
  HeldStream held;
  bool is_live = false;
  SoundReader reader;
  Settings used;                    ///< for this buffer
  GstSegment segment{};             ///< of the audio
  bool is_read = false;             ///< the format is one that can be read
  bool sounded = false;             ///< the last map had levels
  GstFlowReturn flow = GST_FLOW_OK; ///< of the tactile pad
};

} // namespace

struct _GstSoundTactile
{
  GstElement parent;
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

/* ---- the stream ---- */

/* Whether nothing is linked to the tactile pad: then the maps are for a chair in this pipeline. */
static bool
is_free(GstSoundTactile *self)
{
  return self->priv->pads->maps_flow() != GST_FLOW_OK;
}

/* Whether a chair in this pipeline takes the maps, which then need no pad. */
static const fusion::Profile *
joined(GstSoundTactile *self)
{
  return is_free(self) ? self->priv->maps->wanted() : nullptr;
}

/* The pad may be linked or unlinked while the film plays. */
static void
tell_chairs(GstSoundTactile *self)
{
  Private *priv = self->priv;
  if (priv->maps->hear(self, is_free(self)) && priv->is_live)
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_latency(GST_OBJECT(self)));
}

/* For a chair in this pipeline. */
static void
keep_map(GstSoundTactile *self, const tactile::TactileMap &map, GstClockTime begin,
         GstClockTime end)
{
  const GstSegment &segment = self->priv->segment;
  guint64 from = 0;
  guint64 until = 0;
  if (segment.format != GST_FORMAT_TIME
      || !gst_segment_clip(&segment, GST_FORMAT_TIME, begin, end, &from, &until))
    return;
  const std::optional<fusion::Time> first = running_time::of(segment, from);
  const std::optional<fusion::Time> last = running_time::of(segment, until);
  if (first && last)
    self->priv->maps->add(self, { *first, *last, map });
}

static SoundReader::MapSink
map_sink(GstSoundTactile *self)
{
  if (joined(self))
    return [self](const tactile::TactileMap &map, GstClockTime begin, GstClockTime end) {
      keep_map(self, map, begin, end);
    };
  return [self](const tactile::TactileMap &map, GstClockTime begin, GstClockTime end) {
    GstBuffer *buffer = gst_tactile_map_buffer_new(map.levels.data(), map.levels.size());
    gst_buffer_set_tactile_frequency(buffer, map.frequency);
    GST_BUFFER_PTS(buffer) = begin;
    GST_BUFFER_DURATION(buffer) = end - begin;
    const bool sounds = !tactile::is_silent(map);
    if (std::exchange(self->priv->sounded, sounds) || sounds)
      GST_BUFFER_FLAG_SET(buffer, kSoundMap);
    self->priv->pads->announce();
    self->priv->flow = self->priv->pads->push_map(buffer);
  };
}

static void
drain(GstSoundTactile *self)
{
  self->priv->reader.drain(self->priv->used, map_sink(self));
  self->priv->pads->interrupt();
}

/* Another chair, or a pad that was linked late, may want another grid. */
static void
agree_on_grid(GstSoundTactile *self)
{
  Private *priv = self->priv;
  guint rows = 0;
  guint columns = 0;
  if (!priv->pads->wants_grid(&rows, &columns))
    return;
  drain(self);
  priv->pads->announce(rows, columns);
  priv->reader.set_grid(static_cast<int>(rows), static_cast<int>(columns));
}

static void
push_tactile(GstSoundTactile *self, GstBuffer *buffer)
{
  Private *priv = self->priv;
  const GstClockTime pts = GST_BUFFER_PTS(buffer);

  GST_OBJECT_LOCK(self);
  priv->used.feel = priv->settings.feel;
  GST_OBJECT_UNLOCK(self);
  tell_chairs(self);
  if (const fusion::Profile *profile = joined(self)) {
    priv->used.feel.gain_db += profile->gain_db;
    priv->used.feel.impacts &= profile->impacts;
    priv->used.feel.rumble &= profile->rumble;
  }
  if (const bool holds = joined(self) && !priv->is_live; holds != priv->reader.looks_ahead()) {
    drain(self);
    priv->reader.look_ahead(holds);
  }
  agree_on_grid(self);
  priv->flow = priv->pads->maps_flow();
  if (!GST_CLOCK_TIME_IS_VALID(pts))
    return;
  if (!priv->is_read || priv->segment.rate < 0)
    priv->flow = priv->pads->push_gap(pts, GST_BUFFER_DURATION(buffer));
  else
    priv->reader.read(buffer, priv->used, map_sink(self));
}

static GstFlowReturn
gst_sound_tactile_chain(GstPad *, GstObject *parent, GstBuffer *buffer)
{
  auto *self = GST_SOUND_TACTILE(parent);
  Private *priv = self->priv;

  /* The maps first: tactors are needed earlier than loudspeakers. */
  push_tactile(self, buffer);
  return priv->held.hold(buffer, joined(self) && !priv->is_live ? kAhead : 0);
}

/* ---- events ---- */

static void
read_caps(GstSoundTactile *self, GstEvent *event)
{
  Private *priv = self->priv;
  GstCaps *caps = nullptr;
  gst_event_parse_caps(event, &caps);
  drain(self);
  priv->pads->announce();
  GstAudioInfo info;
  priv->is_read = gst_audio_info_from_caps(&info, caps)
                  && priv->reader.set_format(info, static_cast<int>(priv->pads->rows()),
                                             static_cast<int>(priv->pads->columns()));
  if (!priv->is_read)
    GST_ELEMENT_WARNING(self, STREAM, FORMAT,
                        ("This sound is not felt: its channels or its rate are not supported."),
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

/* Serialized events come after the maps of what came before them. */
static gboolean
gst_sound_tactile_sink_event(GstPad *, GstObject *parent, GstEvent *event)
{
  auto *self = GST_SOUND_TACTILE(parent);
  Private *priv = self->priv;

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_CAPS:
    read_caps(self, event);
    break;
  case GST_EVENT_SEGMENT:
    drain(self);
    gst_event_copy_segment(event, &priv->segment);
    priv->is_live = latency::is_live(priv->pads->sink());
    break;
  case GST_EVENT_GAP:
  case GST_EVENT_SEGMENT_DONE:
  case GST_EVENT_EOS:
    drain(self);
    priv->held.drain();
    break;
  case GST_EVENT_FLUSH_START:
    priv->maps->forget(self);
    break;
  case GST_EVENT_FLUSH_STOP:
    priv->reader.reset();
    priv->maps->forget(self); /* what came until the stream had stopped */
    priv->pads->pass_event(event);
    priv->held.flush();
    return TRUE;
  default:
    break;
  }
  return gst_event_type_get_flags(GST_EVENT_TYPE(event)) & GST_EVENT_TYPE_SERIALIZED
             ? priv->held.hold(event)
             : priv->pads->pass_event(event);
}

/* ---- latency ---- */

static gboolean
gst_sound_tactile_tactile_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_SOUND_TACTILE(parent);
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
    return gst_pad_query_default(pad, parent, query);
  if (!gst_pad_peer_query(self->priv->pads->sink(), query))
    return FALSE;
  GST_OBJECT_LOCK(self);
  const GstClockTime own = self->priv->latency;
  GST_OBJECT_UNLOCK(self);
  latency::add(query, own);
  return TRUE;
}

/* ---- the element ---- */

static void
start(GstSoundTactile *self)
{
  GST_OBJECT_LOCK(self);
  self->priv->used = self->priv->settings;
  GST_OBJECT_UNLOCK(self);
  self->priv->pads->set_framerate(static_cast<gint>(self->priv->used.maps_per_second), 1);
  self->priv->maps = sound_maps_of(GST_ELEMENT(self));
  self->priv->maps->hear(self, is_free(self));
}

static void
stop(GstSoundTactile *self)
{
  Private *priv = self->priv;
  if (priv->maps)
    priv->maps->hear(self, false);
  priv->held.clear();
  priv->pads->reset();
  priv->reader.reset();
  priv->is_read = false;
  priv->sounded = false;
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

constexpr auto kDeprecated = static_cast<GParamFlags>(properties::kPlaying | G_PARAM_DEPRECATED);

using P = properties::Property<Settings>;
static constexpr P kProperties[] = {
  P::number<guint>("maps-per-second", "Maps per second on the tactile pad", properties::kReady,
                   PROPERTY_FIELD(maps_per_second), P::Range{ 10, 200 }),
  P::number<gdouble>("gain", "Gain in dB on the sound before its level is measured",
                     properties::kControllable, PROPERTY_FIELD(feel.gain_db), P::Range{ -40, 40 }),
  P::flag("impacts", "Whether impacts, explosions and shots are felt", properties::kPlaying,
          PROPERTY_FIELD(feel.impacts)),
  P::flag("rumble", "Whether continuous sound below 65 Hz is felt", properties::kPlaying,
          PROPERTY_FIELD(feel.rumble)),
  P::flag("blows", "Deprecated, the former name of impacts", kDeprecated,
          PROPERTY_FIELD(feel.impacts)),
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
  delete priv->pads;
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
      "Passes audio through and makes tactile maps of impacts and rumble, but not of voices",
      "The visuotactile authors");
}

static void
gst_sound_tactile_init(GstSoundTactile *self)
{
  self->priv = new Private(
      { [self](GstBuffer *buffer) { return self->priv->pads->pass(buffer, self->priv->flow); },
        [self](GstEvent *event) {
          return self->priv->pads->pass_event(event);
        } });
  gst_segment_init(&self->priv->segment, GST_FORMAT_TIME);
  self->priv->pads = new SplitPads(
      GST_ELEMENT(self), { .chain = GST_DEBUG_FUNCPTR(gst_sound_tactile_chain),
                           .event = GST_DEBUG_FUNCPTR(gst_sound_tactile_sink_event),
                           .tactile_query = GST_DEBUG_FUNCPTR(gst_sound_tactile_tactile_query) });
}
