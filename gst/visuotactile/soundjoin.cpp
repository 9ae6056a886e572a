// SPDX-License-Identifier: LGPL-2.1-or-later
#include "soundjoin.h"

#include "../gaps.h"
#include "../heldstream.h"
#include "../latency.h"
#include "../properties.h"
#include "../runningtime.h"
#include "../soundmode.h"
#include "fusion/fusion.h"
#include "gst/fusion/pipeline_sound.h"
#include "gst/fusion/sound_meta.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

using fusion::SoundMap;
using fusion::Time;
using tactile::TactileMap;

namespace {

/// Maps wait until so much of the film is behind them: an impact that sounds before its picture is
/// felt where it will be seen. In a live stream its sound is known by then, too. Three frames of
/// 30 a second.
constexpr GstClockTime kLookAhead = 95 * GST_MSECOND;

/// Frame duration if the caps have no framerate: 1/24 s.
constexpr GstClockTime kUsualFrame = 42 * GST_MSECOND;

struct Settings
{
  SoundMode sound = SoundMode::film;
};

struct Private
{
  explicit Private(HeldStream::Ways ways) : held(std::move(ways))
  {
  }

  Settings settings;                       ///< object lock
  std::shared_ptr<fusion::SoundMaps> maps; ///< object lock; from PAUSED on

  std::atomic<GstClockTime> frame{ kUsualFrame };

  /* Streaming thread, or while it is stopped. */
  HeldStream held;
  GstSegment segment{};
  guint rows = 0;
  guint columns = 0;
  fusion::Fusion fusion;
  bool sounded = false;    ///< the last map had sound
  bool interrupted = true; ///< the next map does not follow the last one
};

} // namespace

struct _GstSoundJoin
{
  GstElement parent;

  GstPad *sinkpad;
  GstPad *srcpad;
  Private *priv;
};

#define gst_sound_join_parent_class parent_class
G_DEFINE_TYPE(GstSoundJoin, gst_sound_join, GST_TYPE_ELEMENT);

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));

/// The sound that joins, and its mix.
struct Joined
{
  std::shared_ptr<fusion::SoundMaps> maps;
  const fusion::Profile *profile = nullptr;

  explicit operator bool() const
  {
    return profile && maps && maps->is_heard();
  }
};

static Joined
joined(GstSoundJoin *self)
{
  GST_OBJECT_LOCK(self);
  const Joined joined{ self->priv->maps, profile_of(self->priv->settings.sound) };
  GST_OBJECT_UNLOCK(self);
  return joined;
}

/* ---- maps ---- */

static GstFlowReturn
push(GstSoundJoin *self, GstBuffer *map)
{
  if (std::exchange(self->priv->interrupted, false) && !GST_BUFFER_IS_DISCONT(map)) {
    map = gst_buffer_make_writable(map);
    GST_BUFFER_FLAG_SET(map, GST_BUFFER_FLAG_DISCONT);
  }
  return gst_pad_push(self->srcpad, map);
}

static GstFlowReturn
push_piece(GstSoundJoin *self, const SoundMap &piece, const TactileMap &felt)
{
  Private *priv = self->priv;
  const bool sounds = !piece.map.levels.empty();
  const auto position = [priv](Time time) {
    return running_time::to_position(priv->segment, time);
  };
  GstBuffer *buffer = gst_tactile_map_buffer_new(felt.levels.data(), felt.levels.size());
  gst_buffer_set_tactile_frequency(buffer, felt.frequency);
  GST_BUFFER_PTS(buffer) = position(piece.begin);
  GST_BUFFER_DURATION(buffer) = position(piece.end) - GST_BUFFER_PTS(buffer);
  if (std::exchange(priv->sounded, sounds) || sounds)
    GST_BUFFER_FLAG_SET(buffer, kSoundMap);
  return push(self, buffer);
}

static std::optional<TactileMap>
read_map(GstSoundJoin *self, GstBuffer *buffer)
{
  const Private *priv = self->priv;
  gfloat *levels = nullptr;
  gsize count = 0;
  if (priv->rows == 0
      || !gst_tactile_map_buffer_get_levels(buffer, priv->rows, priv->columns, &levels, &count))
    return std::nullopt;
  TactileMap map(static_cast<int>(priv->rows), static_cast<int>(priv->columns));
  std::copy_n(levels, count, map.levels.begin());
  map.frequency = gst_buffer_get_tactile_frequency(buffer);
  g_free(levels);
  return map;
}

/// The first held map that is not silent.
static std::optional<TactileMap>
next_place(GstSoundJoin *self)
{
  std::optional<TactileMap> found;
  self->priv->held.look_through([&](GstBuffer *buffer) {
    found = read_map(self, buffer);
    return found && !tactile::is_silent(*found);
  });
  return found;
}

/// Pushes the maps of picture and sound in this time. False if there is none.
static bool
fuse(GstSoundJoin *self, GstClockTime pts, GstClockTime duration, const TactileMap &picture,
     GstFlowReturn *flow)
{
  Private *priv = self->priv;
  const Joined sound = joined(self);
  if (!sound || priv->segment.format != GST_FORMAT_TIME || priv->segment.rate < 0
      || !GST_CLOCK_TIME_IS_VALID(pts) || !GST_CLOCK_TIME_IS_VALID(duration))
    return false;
  const GstClockTime last = GST_CLOCK_TIME_IS_VALID(priv->segment.stop)
                                ? std::min(pts + duration, priv->segment.stop)
                                : pts + duration;
  const std::optional<Time> begin
      = running_time::of(priv->segment, std::max(pts, priv->segment.start));
  const std::optional<Time> end = running_time::of(priv->segment, last);
  if (!begin || !end || *begin >= *end)
    return false;
  const std::vector<SoundMap> heard = sound.maps->between(*begin, *end);
  const std::optional<TactileMap> next = heard.empty() ? std::nullopt : next_place(self);
  for (const SoundMap &piece : fusion::pieces(*begin, *end, heard)) {
    const TactileMap felt = priv->fusion.mix(piece.begin, piece.end, picture, piece.map,
                                             sound.profile->mix, next ? &*next : nullptr);
    *flow = push_piece(self, piece, felt);
    if (*flow != GST_FLOW_OK)
      break;
  }
  return true;
}

static GstFlowReturn
pass(GstSoundJoin *self, GstBuffer *buffer)
{
  GstFlowReturn flow = GST_FLOW_OK;
  self->priv->interrupted |= GST_BUFFER_IS_DISCONT(buffer);
  if (!joined(self))
    return push(self, buffer);
  // tactorsink posts the error of a faulty map.
  const std::optional<TactileMap> picture = read_map(self, buffer);
  if (!picture || !fuse(self, GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer), *picture, &flow))
    return push(self, buffer);
  gst_buffer_unref(buffer);
  return flow;
}

/// A gap of the picture may have sound.
static gboolean
pass_gap(GstSoundJoin *self, GstEvent *event)
{
  Private *priv = self->priv;
  GstClockTime pts = GST_CLOCK_TIME_NONE;
  GstClockTime duration = GST_CLOCK_TIME_NONE;
  GstFlowReturn flow = GST_FLOW_OK;
  gst_event_parse_gap(event, &pts, &duration);
  const TactileMap silent(static_cast<int>(std::max(priv->rows, 1u)),
                          static_cast<int>(std::max(priv->columns, 1u)));
  if (priv->rows == 0 || is_loss(event) || !fuse(self, pts, duration, silent, &flow))
    return gst_pad_push_event(self->srcpad, event);
  gst_event_unref(event);
  return flow == GST_FLOW_OK;
}

static gboolean
pass_event(GstSoundJoin *self, GstEvent *event)
{
  Private *priv = self->priv;
  GstCaps *caps = nullptr;
  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_GAP:
    return pass_gap(self, event);
  case GST_EVENT_SEGMENT:
    gst_event_copy_segment(event, &priv->segment);
    priv->interrupted = true;
    break;
  case GST_EVENT_CAPS:
    gst_event_parse_caps(event, &caps);
    gst_tactile_map_caps_parse(caps, &priv->rows, &priv->columns, nullptr, nullptr);
    break;
  default:
    break;
  }
  return gst_pad_push_event(self->srcpad, event);
}

/* ---- a live source ---- */

/// Duration of the whole frames that wait, by which the maps of a live source are late. If frames
/// are long, only whole ones within the time wait.
static GstClockTime
look_ahead(GstSoundJoin *self)
{
  const GstClockTime frame = self->priv->frame;
  const GstClockTime rounding = frame <= kUsualFrame ? frame - 1 : 0;
  return (kLookAhead + rounding) / frame * frame;
}

GstClockTime
gst_sound_join_most_latency(GstSoundJoin *self)
{
  return joined(self) ? kLookAhead + kUsualFrame : 0;
}

static gboolean
gst_sound_join_src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_SOUND_JOIN(parent);
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
    return gst_pad_query_default(pad, parent, query);
  if (!gst_pad_peer_query(self->sinkpad, query))
    return FALSE;
  if (latency::is_live(query) && joined(self))
    latency::add(query, look_ahead(self));
  return TRUE;
}

/// Reads the framerate, before the held maps pass.
static void
read_framerate(GstSoundJoin *self, GstEvent *event)
{
  GstCaps *caps = nullptr;
  gint n = 0;
  gint d = 1;
  gst_event_parse_caps(event, &caps);
  const bool known = gst_tactile_map_caps_parse(caps, nullptr, nullptr, &n, &d) && n > 0;
  const GstClockTime frame
      = known ? std::max<GstClockTime>(gst_util_uint64_scale_int(GST_SECOND, d, n), 1)
              : kUsualFrame;
  if (self->priv->frame.exchange(frame) != frame && latency::is_live(self->sinkpad) && joined(self))
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_latency(GST_OBJECT(self)));
}

/* ---- stream ---- */

static GstFlowReturn
gst_sound_join_chain(GstPad *, GstObject *parent, GstBuffer *buffer)
{
  auto *self = GST_SOUND_JOIN(parent);
  return self->priv->held.hold(buffer, joined(self) ? look_ahead(self) : 0);
}

static gboolean
gst_sound_join_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  auto *self = GST_SOUND_JOIN(parent);
  Private *priv = self->priv;

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_FLUSH_STOP:
    priv->fusion.reset();
    priv->sounded = false;
    priv->interrupted = true;
    gst_pad_event_default(pad, parent, event);
    priv->held.flush();
    return TRUE;
  case GST_EVENT_CAPS:
    read_framerate(self, event);
    break;
  case GST_EVENT_GAP:
  case GST_EVENT_SEGMENT_DONE:
  case GST_EVENT_EOS:
    priv->held.drain();
    break;
  default:
    break;
  }
  return gst_event_type_get_flags(GST_EVENT_TYPE(event)) & GST_EVENT_TYPE_SERIALIZED
             ? priv->held.hold(event)
             : gst_pad_event_default(pad, parent, event);
}

/* ---- the element ---- */

static void
gst_sound_join_meet(GstSoundJoin *self)
{
  auto maps = sound_maps_of(GST_ELEMENT(self));
  GST_OBJECT_LOCK(self);
  self->priv->maps = maps;
  const fusion::Profile *profile = profile_of(self->priv->settings.sound);
  GST_OBJECT_UNLOCK(self);
  maps->want(self, profile);
}

static void
gst_sound_join_leave(GstSoundJoin *self)
{
  Private *priv = self->priv;
  GST_OBJECT_LOCK(self);
  const auto maps = std::exchange(priv->maps, nullptr);
  GST_OBJECT_UNLOCK(self);
  if (maps)
    maps->want(self, nullptr);
  priv->held.clear();
  priv->fusion.reset();
  priv->sounded = false;
  priv->interrupted = true;
  priv->rows = priv->columns = 0;
  priv->frame = kUsualFrame;
  gst_segment_init(&priv->segment, GST_FORMAT_UNDEFINED);
}

static GstStateChangeReturn
gst_sound_join_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_SOUND_JOIN(element);
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED)
    gst_sound_join_meet(self);
  const GstStateChangeReturn ret
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    gst_sound_join_leave(self);
  return ret;
}

using P = properties::Property<Settings>;
static constexpr P kProperties[] = {
  P::choice("sound", "What of the sound is felt, and how", properties::kPlaying,
            PROPERTY_FIELD(sound), sound_mode_type),
};

static Settings &
gst_sound_join_settings(GObject *object)
{
  return GST_SOUND_JOIN(object)->priv->settings;
}

static void
gst_sound_join_changed(GObject *object, std::string_view)
{
  auto *self = GST_SOUND_JOIN(object);
  const Joined sound = joined(self);
  if (sound.maps)
    sound.maps->want(self, sound.profile);
  if (sound.maps && latency::is_live(self->sinkpad))
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_latency(GST_OBJECT(self)));
}

static void
gst_sound_join_finalize(GObject *object)
{
  delete GST_SOUND_JOIN(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_sound_join_class_init(GstSoundJoinClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);

  G_OBJECT_CLASS(klass)->finalize = gst_sound_join_finalize;
  properties::install<Settings>(G_OBJECT_CLASS(klass), kProperties,
                                { gst_sound_join_settings, gst_sound_join_changed });
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_sound_join_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(element_class, "Sound join", "Filter",
                                        "Joins the maps of the sound to those of the picture",
                                        "The visuotactile authors");
}

static void
gst_sound_join_init(GstSoundJoin *self)
{
  self->priv = new Private({ [self](GstBuffer *buffer) { return pass(self, buffer); },
                             [self](GstEvent *event) {
                               return pass_event(self, event);
                             } });
  gst_segment_init(&self->priv->segment, GST_FORMAT_UNDEFINED);

  self->sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_sound_join_chain));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_sound_join_sink_event));
  GST_PAD_SET_PROXY_CAPS(self->sinkpad);
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_sound_join_src_query));
  GST_PAD_SET_PROXY_CAPS(self->srcpad);
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);
}

GstElement *
gst_sound_join_new(const gchar *name)
{
  return GST_ELEMENT(g_object_new(GST_TYPE_SOUND_JOIN, "name", name, nullptr));
}
