// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactilesubtitles
 * @title: tactilesubtitles
 * @short_description: puts a tactile track in subtitles on the frames, in any player
 *
 * tactilesubtitles receives a film and its subtitles. The first cue determines the kind of
 * subtitles:
 *
 * - A tactile track, in text cues of [tactileconverter](tactileconverter.md): each frame gets the
 *   map at its time as a #GstTactileMeta, or a silent one, and the chair those that begin or end
 *   within the frame, at their own times: up to 1000, then silence. The element draws remarks,
 *   which are cues of words that do not begin with a digit. It drops any other cue that is not a
 *   map, with a warning; tactile-track refuses such files.
 * - Text: the child `words`, a `textoverlay`, draws it on the film. Frames get no map, and
 *   `visuotactilesink` analyzes them.
 *
 * The track of a transport stream arrives in GAP events from [tactileklvdec](tactileklvdec.md).
 *
 * playbin and playbin3 select this element by its rank, which is NONE by default:
 *
 * |[
 * GST_PLUGIN_FEATURE_RANK=tactilesubtitles:MAX gst-play-1.0 --videosink=visuotactilesink CARRIER
 * ]|
 *
 * [tactilecombiner](tactilecombiner.md) waits for the track; this element never delays the film. A
 * late cue applies from its arrival. Early cues wait, up to 16 million levels (13 hours of 8 × 8
 * at 5 Hz); more are dropped with a warning.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 filesrc location=CARRIER ! matroskademux name=d d.video_0 ! queue ! \
 *     decodebin ! videoconvert ! \
 *     tactilesubtitles name=t ! visuotactilesink driver=simulator d.subtitle_0 ! queue ! \
 *     t.text_sink
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactilesubtitles.h"

#include "../runningtime.h"
#include "gst/cues/cue_stream.h"
#include "gst/cues/film_start.h"
#include "gst/fusion/later_maps.h"
#include "gst/video/video_direction.h"
#include "gst/video/writable_frame.h"
#include "gsttactileelements.h"
#include "tactile/mix.h"
#include "tracks/text_cue.h"
#include "tracks/track.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

using tactile::TactileMap;

GST_DEBUG_CATEGORY_STATIC(tactile_subtitles_debug);
#define GST_CAT_DEFAULT tactile_subtitles_debug

namespace {

/// Most levels that wait for their frames. A sidecar file comes all at once; this holds
/// hours of 8 × 8 maps.
constexpr std::size_t kMaxLevels = 16'000'000;

/// Duration of a cue without one, as in tactileconverter.
constexpr GstClockTime kDefaultDuration = GST_SECOND;

/// The time of a frame that is before all cues.
constexpr tactile::Time kBeforeAll = tactile::Time::min();

/// Most maps on one frame: of a still picture that is shown for long.
constexpr std::size_t kMostMaps = 1000;

/// A map and its running time.
struct Cue
{
  GstClockTime pts = 0; ///< in the track
  tactile::Time begin{ 0 };
  tactile::Time end{ 0 };
  TactileMap map;
};

/// Kind of the subtitles.
enum class Kind
{
  unknown, ///< before the first cue
  track,
  words,
};

/// Segment of a pad.
GstSegment
segment_of(GstPad *pad)
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
  if (event)
    gst_event_copy_segment(event, &segment);
  return segment;
}

/// The part of their names that the streams of one file share (gst_pad_create_stream_id()); empty
/// before the first one.
std::string
source_of(GstPad *pad)
{
  g_autofree gchar *id = gst_pad_get_stream_id(pad);
  const std::string_view whole = id ? id : "";
  return std::string(whole.substr(0, whole.find_first_of(":/")));
}

} // namespace

/// Guarded by the object lock.
struct GstTactileSubtitlesPrivate
{
  Kind kind = Kind::unknown;
  tactile::Grid grid; ///< of the last cue
  std::deque<Cue> cues;
  std::size_t levels = 0; ///< in cues
  bool warned = false;
  bool warned_of_fault = false;
  std::string film;  ///< where the frames come from
  FilmStart start{}; ///< its 0:00
};

struct _GstTactileSubtitles
{
  GstBin parent;
  GstPad *text; ///< of a child, or NULL
  GstTactileSubtitlesPrivate *priv;
};

#define gst_tactile_subtitles_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileSubtitles, gst_tactile_subtitles, GST_TYPE_BIN,
                        GST_DEBUG_CATEGORY_INIT(tactile_subtitles_debug, "tactilesubtitles", 0,
                                                "subtitles that are a tactile track"));
GST_ELEMENT_REGISTER_DEFINE(tactilesubtitles, "tactilesubtitles", GST_RANK_NONE,
                            GST_TYPE_TACTILE_SUBTITLES);

// subtitleoverlay looks for these pad names and this class.
#define VIDEO_CAPS "video/x-raw; video/x-raw(ANY)"
static GstStaticPadTemplate video_template = GST_STATIC_PAD_TEMPLATE(
    "video_sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
static GstStaticPadTemplate text_template
    = GST_STATIC_PAD_TEMPLATE("text_sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                              GST_STATIC_CAPS("text/x-raw, format = { utf8, pango-markup }"));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));

/* ---- subtitles ---- */

static void
forget_cues(GstTactileSubtitles *self)
{
  GST_OBJECT_LOCK(self);
  self->priv->cues.clear();
  self->priv->levels = 0;
  GST_OBJECT_UNLOCK(self);
}

/// Duration of a buffer, else of its cue.
static GstClockTime
duration_of(GstBuffer *buffer, const tactile::Cue &cue)
{
  if (GST_BUFFER_DURATION_IS_VALID(buffer) && GST_BUFFER_DURATION(buffer) > 0)
    return GST_BUFFER_DURATION(buffer);
  return cue.end > tactile::Time(0) ? static_cast<GstClockTime>(cue.end.count()) : kDefaultDuration;
}

/// Running time of a buffer; none outside of its segment.
static bool
find_running_time(GstPad *pad, GstBuffer *buffer, GstClockTime duration, Cue &cue)
{
  if (!GST_BUFFER_PTS_IS_VALID(buffer))
    return false;
  const GstSegment segment = segment_of(pad);
  guint64 begin = 0;
  guint64 end = 0;
  if (!gst_segment_clip(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer),
                        GST_BUFFER_PTS(buffer) + duration, &begin, &end))
    return false;
  cue.pts = GST_BUFFER_PTS(buffer);
  const std::optional<tactile::Time> first = running_time::of(segment, begin);
  const std::optional<tactile::Time> last = running_time::of(segment, end);
  if (!first || !last)
    return false;
  cue.begin = *first;
  cue.end = *last;
  if (segment.rate < 0) { // a frame at its beginning, now the last, has it; one at its end has not
    std::swap(cue.begin, cue.end);
    cue.begin++;
    cue.end++;
  }
  return true;
}

/// Keeps a map until its frames come, ordered by time. In reverse playback demuxers go from key
/// frame to key frame, but send the cues after each in the film's order.
static void
keep(GstTactileSubtitles *self, const Cue &cue)
{
  GstTactileSubtitlesPrivate *priv = self->priv;
  GST_OBJECT_LOCK(self);
  const bool full = priv->levels + cue.map.levels.size() > kMaxLevels;
  const bool warn = full && !std::exchange(priv->warned, true);
  if (!full) {
    priv->cues.insert(std::ranges::upper_bound(priv->cues, cue.begin, {}, &Cue::begin), cue);
    priv->levels += cue.map.levels.size();
  }
  GST_OBJECT_UNLOCK(self);
  if (warn)
    GST_ELEMENT_WARNING(
        self, RESOURCE, NO_SPACE_LEFT,
        ("The tactile track is too large; parts of it are not felt."),
        ("expected at most %" G_GSIZE_FORMAT " levels before their frames come", kMaxLevels));
}

/// A cue that should be a map is neither felt nor drawn.
static void
warn_of_fault(GstTactileSubtitles *self, GstBuffer *buffer, const tactile::FormatError &error)
{
  GST_WARNING_OBJECT(self, "cue at %" GST_TIME_FORMAT " is no map: %s",
                     GST_TIME_ARGS(GST_BUFFER_PTS(buffer)), error.text().c_str());
  GST_OBJECT_LOCK(self);
  const bool warned = std::exchange(self->priv->warned_of_fault, true);
  GST_OBJECT_UNLOCK(self);
  if (!warned)
    GST_ELEMENT_WARNING(self, STREAM, DECODE,
                        ("The tactile track is faulty; parts of it are not felt."),
                        ("at %" GST_TIME_FORMAT ": %s", GST_TIME_ARGS(GST_BUFFER_PTS(buffer)),
                         error.text().c_str()));
}

/// Takes a map of the track; false for other text.
static bool
take(GstTactileSubtitles *self, GstPad *pad, GstBuffer *buffer, CueForm form)
{
  GstTactileSubtitlesPrivate *priv = self->priv;
  GST_OBJECT_LOCK(self);
  const Kind kind = priv->kind;
  const tactile::Grid grid = priv->grid;
  GST_OBJECT_UNLOCK(self);
  if (kind == Kind::words)
    return false;

  const bool follows = kind == Kind::track;
  const tl::expected<tactile::Cue, tactile::FormatError> read
      = cue_from_buffer(buffer, form, follows ? std::optional(grid) : std::nullopt);
  GST_OBJECT_LOCK(self);
  if (!follows)
    priv->kind = read ? Kind::track : Kind::words;
  if (read)
    priv->grid = { read->map.rows, read->map.columns };
  GST_OBJECT_UNLOCK(self);
  if (!follows)
    GST_INFO_OBJECT(self, "the subtitles are %s", read ? "a tactile track" : "to be read");
  if (!read && follows && !cue_is_remark(buffer, form)) {
    warn_of_fault(self, buffer, read.error());
    return true;
  }
  if (!read)
    return false;
  Cue cue{ .map = read->map };
  if (find_running_time(pad, buffer, duration_of(buffer, *read), cue))
    keep(self, cue);
  return true;
}

static GstPadProbeReturn
on_subtitle(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
  return take(GST_TACTILE_SUBTITLES(data), pad, GST_PAD_PROBE_INFO_BUFFER(info), CueForm::text)
             ? GST_PAD_PROBE_DROP
             : GST_PAD_PROBE_OK;
}

static GstPadProbeReturn
on_subtitle_event(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
  auto *self = GST_TACTILE_SUBTITLES(data);
  GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_STREAM_START: // perhaps other subtitles
    GST_OBJECT_LOCK(self);
    self->priv->kind = Kind::unknown;
    GST_OBJECT_UNLOCK(self);
    forget_cues(self);
    break;
  case GST_EVENT_FLUSH_STOP:
    forget_cues(self);
    break;
  case GST_EVENT_GAP: // tactileklvdec's have a cue
    if (g_autoptr(GstBuffer) packet = cue_gap_get_packet(event))
      take(self, pad, packet, CueForm::klv);
    break;
  default:
    break;
  }
  return GST_PAD_PROBE_OK;
}

/* ---- film ---- */

/// The cue at a time. Rounded times may overlap: the track's later cue counts, also in reverse
/// playback.
static const Cue *
cue_at(const std::deque<Cue> &cues, tactile::Time time)
{
  const Cue *found = nullptr;
  for (const Cue &cue : cues) {
    if (cue.begin > time)
      break;
    if (time < cue.end && (!found || cue.pts > found->pts))
      found = &cue;
  }
  return found;
}

/// The map at a time; times must rise. None without a track.
static std::optional<TactileMap>
map_at(GstTactileSubtitles *self, tactile::Time time)
{
  GstTactileSubtitlesPrivate *priv = self->priv;
  std::optional<TactileMap> map;
  GST_OBJECT_LOCK(self);
  const auto begun
      = std::ranges::upper_bound(priv->cues, time, {}, &Cue::begin) - priv->cues.begin();
  const auto is_over = [&](const Cue &cue) {
    if (cue.end <= time)
      priv->levels -= cue.map.levels.size();
    return cue.end <= time;
  };
  priv->cues.erase(std::remove_if(priv->cues.begin(), priv->cues.begin() + begun, is_over),
                   priv->cues.begin() + begun);
  if (priv->kind == Kind::track) {
    const Cue *cue = cue_at(priv->cues, time);
    map = cue ? cue->map : TactileMap(priv->grid.rows, priv->grid.columns);
  }
  GST_OBJECT_UNLOCK(self);
  return map;
}

/// The maps that follow within a frame of this grid, which is shown in [begin, end) of the track's
/// running time, at this rate. After map_at(begin).
static std::vector<LaterMap>
maps_within(GstTactileSubtitles *self, tactile::Time begin, tactile::Time end, double rate,
            const TactileMap &first)
{
  const std::deque<Cue> &cues = self->priv->cues;
  std::vector<LaterMap> maps;
  GST_OBJECT_LOCK(self);
  std::set<tactile::Time> changes;
  for (const Cue &cue : cues) {
    if (cue.begin >= end)
      break;
    for (const tactile::Time at : { cue.begin, cue.end })
      if (begin < at && at < end)
        changes.insert(at);
  }
  // As in cue_at().
  const auto is_later = [](const Cue *a, const Cue *b) {
    return std::pair(a->pts, b->begin) > std::pair(b->pts, a->begin);
  };
  std::multiset<const Cue *, decltype(is_later)> begun(is_later);
  auto next = cues.begin();
  for (const tactile::Time at : changes) {
    for (; next != cues.end() && next->begin <= at; ++next)
      begun.insert(&*next);
    while (!begun.empty() && (*begun.begin())->end <= at)
      begun.erase(begun.begin());
    const bool is_last = maps.size() + 1 == kMostMaps; // and holds until the next frame
    const Cue *cue = begun.empty() || is_last ? nullptr : *begun.begin();
    const auto after = static_cast<double>((at - begin).count()) * rate;
    maps.push_back({ tactile::Time(static_cast<gint64>(after)),
                     cue ? tactile::resample(cue->map, first.rows, first.columns)
                         : TactileMap(first.rows, first.columns) });
    if (is_last)
      break;
  }
  GST_OBJECT_UNLOCK(self);
  return maps;
}

/// Reads the film's 0:00 from its events.
static GstPadProbeReturn
on_film_event(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
  GstTactileSubtitlesPrivate *priv = GST_TACTILE_SUBTITLES(data)->priv;
  GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
  if (GST_EVENT_TYPE(event) != GST_EVENT_SEGMENT)
    return GST_PAD_PROBE_OK;
  const GstSegment *segment = nullptr;
  gst_event_parse_segment(event, &segment);
  std::string film = source_of(pad);
  GST_OBJECT_LOCK(data);
  if (film != priv->film) {
    priv->film = std::move(film);
    priv->start = {};
  }
  priv->start.add_segment(*segment);
  GST_OBJECT_UNLOCK(data);
  return GST_PAD_PROBE_OK;
}

/// The running time of the cues that a frame has. Subtitles beside a film count from its 0:00, and
/// are sought to the player's position: where that is another time, the running times of both have
/// nothing in common.
static tactile::Time
cue_time(GstTactileSubtitles *self, const GstSegment &film, GstClockTime pts)
{
  GST_OBJECT_LOCK(self);
  const auto start = static_cast<GstClockTime>(self->priv->start.stream_time().count());
  const std::string source = self->priv->film;
  GST_OBJECT_UNLOCK(self);
  if (start == 0 || source_of(self->text) == source)
    return running_time::of(film, pts).value_or(kBeforeAll);
  const GstSegment text = segment_of(self->text);
  const GstClockTime time = gst_segment_to_stream_time(&film, GST_FORMAT_TIME, pts);
  return running_time::of(text, gst_segment_position_from_stream_time(
                                    &text, GST_FORMAT_TIME, std::max(time, start) - start))
      .value_or(kBeforeAll);
}

/// The end of a frame in its segment, by the frame rate where it has no duration.
static GstClockTime
end_of(GstPad *pad, GstBuffer *frame, const GstSegment &segment)
{
  GstClockTime duration = GST_BUFFER_DURATION(frame);
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
  gint n = 0;
  gint d = 1;
  if (!GST_CLOCK_TIME_IS_VALID(duration) && caps
      && gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &n, &d))
    duration = n > 0 ? gst_util_uint64_scale_int(GST_SECOND, d, n) : 0;
  return std::min<GstClockTime>(
      GST_BUFFER_PTS(frame) + (GST_CLOCK_TIME_IS_VALID(duration) ? duration : 0), segment.stop);
}

static GstPadProbeReturn
on_frame(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
  auto *self = GST_TACTILE_SUBTITLES(data);
  GstBuffer *frame = GST_PAD_PROBE_INFO_BUFFER(info);
  const GstSegment segment = segment_of(pad);
  const GstClockTime pts = GST_BUFFER_PTS(frame);
  if (!running_time::of(segment, pts))
    return GST_PAD_PROBE_OK;
  const tactile::Time begin = cue_time(self, segment, pts);
  const std::optional<TactileMap> map = map_at(self, begin);
  if (!map)
    return GST_PAD_PROBE_OK;
  frame = writable_frame(frame);
  GST_PAD_PROBE_INFO_DATA(info) = frame;
  GstTactileMeta *put = gst_buffer_add_tactile_meta(frame, static_cast<guint>(map->rows),
                                                    static_cast<guint>(map->columns),
                                                    map->levels.data(), map->levels.size());
  gst_tactile_meta_set_video_direction(put, direction_at(pad));
  gst_buffer_set_tactile_frequency(frame, map->frequency);
  const tactile::Time end = segment.rate > 0 && begin != kBeforeAll
                                ? cue_time(self, segment, end_of(pad, frame, segment))
                                : begin;
  set_later_maps(frame, maps_within(self, begin, end, segment.rate, *map));
  return GST_PAD_PROBE_OK;
}

/* ---- element ---- */

static GstStateChangeReturn
gst_tactile_subtitles_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_TACTILE_SUBTITLES(element);
  if (transition == GST_STATE_CHANGE_NULL_TO_READY && GST_BIN_NUMCHILDREN(self) == 0) {
    GST_ELEMENT_ERROR(self, CORE, MISSING_PLUGIN, ("tactilesubtitles needs textoverlay."),
                      ("expected the plugin pango of gst-plugins-base"));
    return GST_STATE_CHANGE_FAILURE;
  }
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
    GST_OBJECT_LOCK(self);
    *self->priv = {};
    GST_OBJECT_UNLOCK(self);
  }
  return result;
}

static void
gst_tactile_subtitles_finalize(GObject *object)
{
  delete GST_TACTILE_SUBTITLES(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_subtitles_class_init(GstTactileSubtitlesClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);

  G_OBJECT_CLASS(klass)->finalize = gst_tactile_subtitles_finalize;
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactile_subtitles_change_state);
  gst_element_class_add_static_pad_template(element_class, &video_template);
  gst_element_class_add_static_pad_template(element_class, &text_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile subtitles", "Mixer/Video/Overlay/Subtitle",
      "Puts the maps of a tactile track on a film's frames, and other subtitles on its picture",
      "The visuotactile authors");
}

static GstPad *
add_ghost_pad(GstTactileSubtitles *self, GstElement *child, const gchar *name,
              GstStaticPadTemplate *pad_template)
{
  g_autoptr(GstPadTemplate) of = gst_static_pad_template_get(pad_template);
  GstPad *target = child ? gst_element_get_static_pad(child, name) : nullptr;
  gst_element_add_pad(GST_ELEMENT(self), target
                                             ? gst_ghost_pad_new_from_template(name, target, of)
                                             : gst_ghost_pad_new_no_target_from_template(name, of));
  return target;
}

static void
gst_tactile_subtitles_init(GstTactileSubtitles *self)
{
  self->priv = new GstTactileSubtitlesPrivate;
  GstElement *words = gst_element_factory_make("textoverlay", "words");
  if (words) {
    gst_util_set_object_arg(G_OBJECT(words), "wait-text", "false");
    gst_util_set_object_arg(G_OBJECT(words), "halignment", "center");
    gst_util_set_object_arg(G_OBJECT(words), "valignment", "bottom");
    gst_bin_add(GST_BIN(self), words);
  }
  g_autoptr(GstPad) video = add_ghost_pad(self, words, "video_sink", &video_template);
  g_autoptr(GstPad) text = add_ghost_pad(self, words, "text_sink", &text_template);
  g_autoptr(GstPad) src = add_ghost_pad(self, words, "src", &src_template);
  if (!words)
    return;
  self->text = text; // as long as its element, a child
  gst_pad_add_probe(text, GST_PAD_PROBE_TYPE_BUFFER, on_subtitle, self, nullptr);
  gst_pad_add_probe(video, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, on_film_event, self, nullptr);
  gst_pad_add_probe(text,
                    static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM
                                                 | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
                    on_subtitle_event, self, nullptr);
  gst_pad_add_probe(src, GST_PAD_PROBE_TYPE_BUFFER, on_frame, self, nullptr);
}
