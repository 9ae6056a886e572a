// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactilecombiner
 * @title: tactilecombiner
 * @short_description: puts a track's tactile maps on a film's frames
 *
 * tactilecombiner puts a stream of tactile maps, such as a designer's track from
 * `tactileconverter`, on the frames of a film: each frame gets a #GstTactileMeta with the map at
 * its start, or a silent one where the track has none. The track may be longer, shorter or later
 * than the film. Without a track, the film passes through.
 *
 * With the mixes `replace`, `max` and `sum`, `tactileextractor` also sends the maps that begin or
 * end within a frame, at their own times, except those of sound: up to 1000 of a frame, then
 * silence. With `max` and `sum` they are mixed with the frame's own such maps, as from
 * `tactilesubtitles`; other mixes drop those.
 *
 * #GstTactileCombiner:mix determines what happens to a frame that already has a map, from
 * `saliencytactile`. Unless the map is replaced, the track is resampled to the frame's grid. With
 * maps of `soundtactile` as the track, picture and sound of one event are one cue, as strong as
 * the sound, at the place of the picture up to 250 ms before: with `mix=gate` only when there is a
 * sound, with `mix=accent` also without one. [Sound](../guide/sound.md#profiles) lists the mixes
 * of the profiles.
 *
 * A frame waits until the track is known for its begin, with these three mixes until its end. Put
 * a queue before `sink` that holds a frame more than the branch of the track delays.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=2000000000 ! \
 *     tactilecombiner name=c mix=max ! tactileoverlay ! videoconvert ! autovideosink \
 *     x.tactile ! tactileconverter ! text/x-raw ! tactileconverter ! queue ! c.tactile
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactilecombiner.h"

#include "../properties.h"
#include "../runningtime.h"
#include "fusion/fusion.h"
#include "gst/fusion/later_maps.h"
#include "gst/fusion/sound_meta.h"
#include "gst/video/video_direction.h"
#include "gst/video/writable_frame.h"
#include "gsttactileelements.h"
#include "trackreader.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

using tactile::Mix;
using tactile::TactileMap;
using Part = TrackReader::Part;

GST_DEBUG_CATEGORY_STATIC(tactile_combiner_debug);
#define GST_CAT_DEFAULT tactile_combiner_debug

namespace {

constexpr double kMaxOffset = 360000.0 * GST_SECOND; ///< 100 hours

struct CombinerSettings
{
  Mix mix = Mix::replace;
  gint64 offset = 0; ///< ns
};

} // namespace

struct GstTactileCombinerPrivate
{
  CombinerSettings settings; ///< guarded by the object lock

  /* Aggregator's thread, or while it is stopped. */
  TrackReader track;
  std::vector<Part> parts; ///< of the next frame, as far as they are known
  GstClockTime frame_duration = GST_CLOCK_TIME_NONE; ///< by the frame rate
  fusion::Fusion fusion;
  bool track_ended = false;
  bool track_is_ahead = false; ///< its next stream began, the film's has not yet

  /* What GstAggregator's own functions of the track's pad are called by; set before it has data. */
  GstPadChainFunction chain_track = nullptr;
  GstPadQueryFunction query_track = nullptr;
  std::mutex mutex;
  bool film_is_over = false; ///< guarded by mutex: maps of the track are refused
  int queries = 0;           ///< guarded by mutex: serialized ones of the track that wait
};

struct _GstTactileCombiner
{
  GstAggregator parent;

  GstAggregatorPad *videopad;
  GstTactileCombinerPrivate *priv;
};

#define gst_tactile_combiner_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileCombiner, gst_tactile_combiner, GST_TYPE_AGGREGATOR,
                        GST_DEBUG_CATEGORY_INIT(tactile_combiner_debug, "tactilecombiner", 0,
                                                "tactile track and film"));
GST_ELEMENT_REGISTER_DEFINE(tactilecombiner, "tactilecombiner", GST_RANK_NONE,
                            GST_TYPE_TACTILE_COMBINER);

#define VIDEO_CAPS "video/x-raw(ANY)"

static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
static GstStaticPadTemplate tactile_template = GST_STATIC_PAD_TEMPLATE(
    "tactile", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));

/* ---- frames ---- */

/* What the sound added to the picture's map, and all of it where the picture is not felt. */
static TactileMap
added_to(const TactileMap &picture, const TactileMap &felt, Mix mix)
{
  TactileMap added = felt;
  if (mix != Mix::replace)
    std::ranges::transform(felt.levels, picture.levels, added.levels.begin(),
                           [](float now, float before) { return std::max(now - before, 0.0F); });
  return added;
}

/* The map of a part of a frame, whose own map may be null. */
static TactileMap
mixed(GstTactileCombiner *self, const TactileMap *own, const Part &part, gint64 end, Mix mix)
{
  if (own == nullptr || (mix == Mix::replace && !part.is_sound))
    return part.map;
  return self->priv->fusion.mix(fusion::Time(part.begin), fusion::Time(end), *own, part.map, mix);
}

static void
put_maps(GstTactileCombiner *self, GstBuffer *frame, const std::vector<Part> &parts, gint64 end,
         Mix mix)
{
  const Part &first = parts.front();
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(frame);
  const bool has_own = meta != nullptr;
  TactileMap film;
  if (has_own) {
    film = TactileMap(static_cast<int>(meta->rows), static_cast<int>(meta->columns));
    std::copy_n(meta->levels, film.levels.size(), film.levels.begin());
    film.frequency = gst_buffer_get_tactile_frequency(frame);
  }
  const TactileMap *own = has_own ? &film : nullptr;
  const TactileMap map = mixed(self, own, first, end, mix);
  std::vector<LaterMap> own_later;
  if ((mix == Mix::max || mix == Mix::sum) && !first.is_sound)
    own_later = read_later_maps(frame);
  if (first.is_sound)
    add_sound_meta(frame, has_own ? added_to(film, map, mix) : map);
  GstTactileMeta *put = gst_buffer_add_tactile_meta(frame, static_cast<guint>(map.rows),
                                                    static_cast<guint>(map.columns),
                                                    map.levels.data(), map.levels.size());
  gst_buffer_set_tactile_frequency(frame, map.frequency);
  if (!has_own)
    gst_tactile_meta_set_video_direction(put, direction_at(GST_PAD(self->videopad)));

  /* What begins at a time after the frame's: a map of its own, and a part of the track. */
  std::map<fusion::Time, std::pair<const TactileMap *, const Part *>> changes;
  for (const LaterMap &each : own_later)
    changes[each.after].first = &each.map;
  for (const Part &part : std::span(parts).subspan(1)) {
    GST_OBJECT_LOCK(self->videopad);
    const GstClockTime begin
        = running_time::to_position(self->videopad->segment, fusion::Time(part.begin));
    GST_OBJECT_UNLOCK(self->videopad);
    if (GST_CLOCK_TIME_IS_VALID(begin) && begin > GST_BUFFER_PTS(frame))
      changes[fusion::Time(static_cast<gint64>(begin - GST_BUFFER_PTS(frame)))].second = &part;
  }
  std::vector<LaterMap> later;
  const Part *part = &first;
  for (const auto &[after, change] : changes) {
    own = change.first ? change.first : own;
    part = change.second ? change.second : part;
    later.push_back(
        { after, tactile::resample(mixed(self, own, *part, end, mix), map.rows, map.columns) });
  }
  set_later_maps(frame, later);
}

static GstAggregatorPad *
tactile_pad(GstTactileCombiner *self)
{
  GST_OBJECT_LOCK(self);
  GList *pads = GST_ELEMENT(self)->sinkpads;
  GstAggregatorPad *found = nullptr;
  for (GList *item = pads; item != nullptr; item = item->next)
    if (item->data != self->videopad)
      found = GST_AGGREGATOR_PAD(gst_object_ref(item->data));
  GST_OBJECT_UNLOCK(self);
  return found;
}

/* A track that is longer than the film ends with it. GstAggregator of GStreamer 1.22 empties its
 * pads then; since 1.24 a full one would block its streaming thread for ever. */
static GstFlowReturn
end_film(GstTactileCombiner *self)
{
  GstTactileCombinerPrivate *priv = self->priv;
  GstAggregatorPad *track = tactile_pad(self);
  if (track == nullptr)
    return GST_FLOW_EOS;
  bool is_over = true;
  if (!priv->track_is_ahead) {
    {
      const std::lock_guard lock(priv->mutex);
      priv->film_is_over = is_over = priv->queries == 0;
    }
    while (gst_aggregator_pad_drop_buffer(track))
      ;
  }
  gst_object_unref(track);
  return is_over ? GST_FLOW_EOS : GST_AGGREGATOR_FLOW_NEED_DATA; /* once they are answered */
}

/* What GstAggregator makes of a GAP event of the film: a buffer without data. */
static bool
is_gap(GstBuffer *frame)
{
  return GST_BUFFER_FLAG_IS_SET(frame, GST_BUFFER_FLAG_GAP) && GST_BUFFER_PTS_IS_VALID(frame)
         && gst_buffer_get_size(frame) == 0;
}

/* Makes a GAP event of it again, behind what GstAggregator sends before it. */
static GstPadProbeReturn
pass_gap(GstPad *pad, GstPadProbeInfo *info, gpointer)
{
  GstBuffer *frame = GST_PAD_PROBE_INFO_BUFFER(info);
  if (!is_gap(frame))
    return GST_PAD_PROBE_OK;
  GstEvent *gap = gst_event_new_gap(GST_BUFFER_PTS(frame), GST_BUFFER_DURATION(frame));
  if (is_lost(frame))
    gst_event_set_gap_flags(gap, GST_GAP_FLAG_MISSING_DATA);
  gst_pad_push_event(pad, gap);
  return GST_PAD_PROBE_DROP;
}

static GstFlowReturn
gst_tactile_combiner_aggregate(GstAggregator *aggregator, gboolean timeout)
{
  auto *self = GST_TACTILE_COMBINER(aggregator);

  GstBuffer *frame = gst_aggregator_pad_peek_buffer(self->videopad);
  if (frame == nullptr)
    return gst_aggregator_pad_is_eos(self->videopad) ? end_film(self)
                                                     : GST_AGGREGATOR_FLOW_NEED_DATA;
  const std::optional<gint64> time = TrackReader::time_of(self->videopad, GST_BUFFER_PTS(frame));
  GST_OBJECT_LOCK(self);
  const auto [mix, offset] = self->priv->settings;
  GST_OBJECT_UNLOCK(self);
  const GstClockTime duration = GST_BUFFER_DURATION_IS_VALID(frame) ? GST_BUFFER_DURATION(frame)
                                                                    : self->priv->frame_duration;
  const gint64 begin = time.value_or(0);
  const gint64 end = TrackReader::end_of(self->videopad, frame, duration, begin).value_or(begin);
  gst_buffer_unref(frame);

  GstAggregatorPad *track = tactile_pad(self);
  std::vector<Part> &parts = self->priv->parts;
  if (track != nullptr && time) {
    GST_OBJECT_LOCK(self->videopad);
    const bool is_reverse = self->videopad->segment.rate < 0;
    GST_OBJECT_UNLOCK(self->videopad);
    /* Other mixes depend on what was before. */
    const bool splits = !is_reverse && (mix == Mix::replace || mix == Mix::max || mix == Mix::sum);
    if (!parts.empty() && parts.front().begin != begin) /* the film alone was flushed */
      parts.clear();
    const GstFlowReturn flow = self->priv->track.add_parts(
        track, offset, begin, splits ? std::max(end, begin + 1) : begin + 1, parts);
    if (flow != GST_FLOW_OK && !(flow == GST_AGGREGATOR_FLOW_NEED_DATA && timeout)) {
      gst_object_unref(track);
      return flow;
    }
  }
  frame = gst_aggregator_pad_pop_buffer(self->videopad);
  if (frame == nullptr) { /* flushed meanwhile */
    gst_clear_object(&track);
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  /* A track without any caps has no grid. */
  if (track != nullptr && time && self->priv->track.has_grid() && !is_gap(frame)) {
    frame = writable_frame(frame);
    if (parts.empty()) /* a live film does not wait */
      parts.push_back(self->priv->track.part_at(*time));
    put_maps(self, frame, parts, end, mix);
  }
  parts.clear();
  gst_clear_object(&track);
  if (GST_BUFFER_PTS_IS_VALID(frame)) {
    GstSegment *segment = &GST_AGGREGATOR_PAD(aggregator->srcpad)->segment;
    segment->position = GST_BUFFER_PTS(frame);
    if (GST_BUFFER_DURATION_IS_VALID(frame))
      segment->position += GST_BUFFER_DURATION(frame);
  }
  return gst_aggregator_finish_buffer(aggregator, frame);
}

/* ---- the track's pad ---- */

static GstFlowReturn
track_chain(GstPad *pad, GstObject *parent, GstBuffer *map)
{
  GstTactileCombinerPrivate *priv = GST_TACTILE_COMBINER(parent)->priv;
  {
    const std::lock_guard lock(priv->mutex);
    if (priv->film_is_over) {
      gst_buffer_unref(map);
      return GST_FLOW_EOS;
    }
  }
  return priv->chain_track(pad, parent, map);
}

static gboolean
track_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  GstTactileCombinerPrivate *priv = GST_TACTILE_COMBINER(parent)->priv;
  if (!(gst_query_type_get_flags(GST_QUERY_TYPE(query)) & GST_QUERY_TYPE_SERIALIZED))
    return priv->query_track(pad, parent, query);
  {
    const std::lock_guard lock(priv->mutex);
    if (priv->film_is_over)
      return FALSE;
    priv->queries++;
  }
  const gboolean answered = priv->query_track(pad, parent, query);
  const std::lock_guard lock(priv->mutex);
  priv->queries--;
  return answered;
}

static GstAggregatorPad *
gst_tactile_combiner_create_new_pad(GstAggregator *aggregator, GstPadTemplate *templ,
                                    const gchar *name, const GstCaps *caps)
{
  GstTactileCombinerPrivate *priv = GST_TACTILE_COMBINER(aggregator)->priv;
  GstAggregatorPad *track
      = GST_AGGREGATOR_CLASS(parent_class)->create_new_pad(aggregator, templ, name, caps);
  if (track == nullptr)
    return nullptr;
  priv->chain_track = GST_PAD_CHAINFUNC(track);
  priv->query_track = GST_PAD_QUERYFUNC(track);
  gst_pad_set_chain_function(GST_PAD(track), GST_DEBUG_FUNCPTR(track_chain));
  gst_pad_set_query_function(GST_PAD(track), GST_DEBUG_FUNCPTR(track_query));
  return track;
}

/* On the pad's streaming thread, before the event is queued. */
static GstFlowReturn
gst_tactile_combiner_sink_event_pre_queue(GstAggregator *aggregator, GstAggregatorPad *pad,
                                          GstEvent *event)
{
  auto *self = GST_TACTILE_COMBINER(aggregator);
  const bool begins = GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START
                      || GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP;
  if (begins && pad != self->videopad) {
    const std::lock_guard lock(self->priv->mutex);
    self->priv->film_is_over = false;
  }
  return GST_AGGREGATOR_CLASS(parent_class)->sink_event_pre_queue(aggregator, pad, event);
}

/* ---- events and queries: the source pad has the film's ---- */

static gboolean
gst_tactile_combiner_sink_event(GstAggregator *aggregator, GstAggregatorPad *pad, GstEvent *event)
{
  auto *self = GST_TACTILE_COMBINER(aggregator);
  const bool is_video = pad == self->videopad;

  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
    GstCaps *caps = nullptr;
    gst_event_parse_caps(event, &caps);
    if (is_video) {
      gint n = 0;
      gint d = 1;
      gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &n, &d);
      self->priv->frame_duration
          = n > 0 ? gst_util_uint64_scale_int(GST_SECOND, d, n) : GST_CLOCK_TIME_NONE;
      gst_aggregator_set_src_caps(aggregator, caps);
    } else if (!self->priv->track.set_caps(caps)) {
      gst_event_unref(event);
      return FALSE;
    }
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT) {
    const GstSegment *segment = nullptr;
    gst_event_parse_segment(event, &segment);
    if (is_video)
      gst_aggregator_update_segment(aggregator, segment);
    else
      self->priv->track.clear();
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_EOS && !is_video) {
    self->priv->track_ended = true;
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START) {
    const bool ended = std::exchange(self->priv->track_ended, false);
    self->priv->track_is_ahead = ended && !is_video;
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_TAG && !is_video) {
    gst_event_unref(event); /* what is about the track is not about the film */
    return TRUE;
  }
  return GST_AGGREGATOR_CLASS(parent_class)->sink_event(aggregator, pad, event);
}

static gboolean
gst_tactile_combiner_sink_query(GstAggregator *aggregator, GstAggregatorPad *pad, GstQuery *query)
{
  auto *self = GST_TACTILE_COMBINER(aggregator);
  if (pad == self->videopad)
    switch (GST_QUERY_TYPE(query)) {
    case GST_QUERY_CAPS:
    case GST_QUERY_ALLOCATION:
    case GST_QUERY_ACCEPT_CAPS:
      if (gst_pad_peer_query(aggregator->srcpad, query))
        return TRUE;
      break;
    default:
      break;
    }
  return GST_AGGREGATOR_CLASS(parent_class)->sink_query(aggregator, pad, query);
}

static gboolean
gst_tactile_combiner_src_query(GstAggregator *aggregator, GstQuery *query)
{
  auto *self = GST_TACTILE_COMBINER(aggregator);
  switch (GST_QUERY_TYPE(query)) {
  case GST_QUERY_POSITION:
  case GST_QUERY_DURATION:
  case GST_QUERY_URI:
  case GST_QUERY_CAPS:
  case GST_QUERY_ALLOCATION:
    return gst_pad_peer_query(GST_PAD(self->videopad), query);
  default:
    return GST_AGGREGATOR_CLASS(parent_class)->src_query(aggregator, query);
  }
}

static GstFlowReturn
gst_tactile_combiner_flush(GstAggregator *aggregator)
{
  GstTactileCombinerPrivate *priv = GST_TACTILE_COMBINER(aggregator)->priv;
  priv->track.clear();
  priv->parts.clear();
  priv->fusion.reset();
  priv->track_ended = priv->track_is_ahead = false;
  return GST_FLOW_OK;
}

static gboolean
gst_tactile_combiner_stop(GstAggregator *aggregator)
{
  GstTactileCombinerPrivate *priv = GST_TACTILE_COMBINER(aggregator)->priv;
  priv->track.reset();
  priv->parts.clear();
  priv->fusion.reset();
  priv->track_ended = priv->track_is_ahead = false;
  const std::lock_guard lock(priv->mutex);
  priv->film_is_over = false;
  return TRUE;
}

/* ---- properties ---- */

static GType
mix_type(void)
{
  static const GEnumValue values[] = {
    { static_cast<gint>(Mix::replace), "The track alone", tactile::name_of(Mix::replace) },
    { static_cast<gint>(Mix::max), "In each cell the stronger of the film's own map and the track",
      tactile::name_of(Mix::max) },
    { static_cast<gint>(Mix::sum), "In each cell the sum of both, at most 1",
      tactile::name_of(Mix::sum) },
    { static_cast<gint>(Mix::gate),
      "The film's own map with the track's strength, so that both are silent while the track is; "
      "the track where the film has no map",
      tactile::name_of(Mix::gate) },
    { static_cast<gint>(Mix::accent),
      "The film's own map, with the track's strength while the track is stronger; the track where "
      "the film has no map",
      tactile::name_of(Mix::accent) },
    { static_cast<gint>(Mix::stress), "As accent, but silent where the film has no map",
      tactile::name_of(Mix::stress) },
    { 0, nullptr, nullptr },
  };
  static const GType type = properties::register_enum("GstTactileCombinerMix", values);
  return type;
}

using P = properties::Property<CombinerSettings>;
static constexpr P kProperties[] = {
  P::choice("mix", "Treatment of a map that a frame already has", properties::kPlaying,
            PROPERTY_FIELD(mix), mix_type),
  P::number<gint64>("offset", "Delay of the track in ns; negative: the track is earlier",
                    properties::kPlaying, PROPERTY_FIELD(offset),
                    P::Range{ -kMaxOffset, kMaxOffset }),
};

static CombinerSettings &
gst_tactile_combiner_settings(GObject *object)
{
  return GST_TACTILE_COMBINER(object)->priv->settings;
}

static void
gst_tactile_combiner_finalize(GObject *object)
{
  delete GST_TACTILE_COMBINER(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_combiner_class_init(GstTactileCombinerClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);
  auto *aggregator_class = GST_AGGREGATOR_CLASS(klass);

  object_class->finalize = gst_tactile_combiner_finalize;
  properties::install<CombinerSettings>(object_class, kProperties,
                                        { gst_tactile_combiner_settings });

  gst_element_class_add_static_pad_template_with_gtype(element_class, &sink_template,
                                                       GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_add_static_pad_template_with_gtype(element_class, &tactile_template,
                                                       GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_add_static_pad_template_with_gtype(element_class, &src_template,
                                                       GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_set_static_metadata(element_class, "Tactile map combiner", "Filter",
                                        "Puts a track's tactile maps on a film's frames",
                                        "The visuotactile authors");

  aggregator_class->aggregate = GST_DEBUG_FUNCPTR(gst_tactile_combiner_aggregate);
  aggregator_class->create_new_pad = GST_DEBUG_FUNCPTR(gst_tactile_combiner_create_new_pad);
  aggregator_class->sink_event_pre_queue
      = GST_DEBUG_FUNCPTR(gst_tactile_combiner_sink_event_pre_queue);
  aggregator_class->sink_event = GST_DEBUG_FUNCPTR(gst_tactile_combiner_sink_event);
  aggregator_class->sink_query = GST_DEBUG_FUNCPTR(gst_tactile_combiner_sink_query);
  aggregator_class->src_query = GST_DEBUG_FUNCPTR(gst_tactile_combiner_src_query);
  aggregator_class->flush = GST_DEBUG_FUNCPTR(gst_tactile_combiner_flush);
  aggregator_class->stop = GST_DEBUG_FUNCPTR(gst_tactile_combiner_stop);
  aggregator_class->get_next_time = GST_DEBUG_FUNCPTR(gst_aggregator_simple_get_next_time);
  aggregator_class->negotiate = nullptr; /* the film's caps are ours */
}

static void
gst_tactile_combiner_init(GstTactileCombiner *self)
{
  self->priv = new GstTactileCombinerPrivate;
  GstPadTemplate *templ = gst_static_pad_template_get(&sink_template);
  self->videopad
      = GST_AGGREGATOR_PAD(g_object_new(GST_TYPE_AGGREGATOR_PAD, "name", "sink", "direction",
                                        GST_PAD_SINK, "template", templ, nullptr));
  gst_object_unref(templ);
  gst_element_add_pad(GST_ELEMENT(self), GST_PAD(self->videopad));
  gst_pad_add_probe(GST_AGGREGATOR_SRC_PAD(self), GST_PAD_PROBE_TYPE_BUFFER, pass_gap, nullptr,
                    nullptr);
}
