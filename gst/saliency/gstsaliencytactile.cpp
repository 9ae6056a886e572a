// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-saliencytactile
 * @title: saliencytactile
 * @short_description: finds what draws the eye and adds it to each frame as a tactile map
 *
 * saliencytactile analyses the frames that pass through it and adds a #GstTactileMeta to each: a
 * small grid of levels, 3 × 3 by default, that says where and how strongly the film shall be felt.
 * Pixels and memory are left as they are.
 *
 * The analysis is "Saliency-Driven Tactile Effect Authoring for Real-Time Visuotactile Feedback"
 * (Kim, Lee, Choi 2012): spatial centre-surround contrast in CIE L*a*b*, temporal centre-surround
 * contrast of the resulting maps, a threshold, pooling to the grid. `profile=paper` takes the paper
 * literally; the default, `profile=tuned`, feels what appears or moves, and neither what went away
 * nor sensor noise, cuts, fades or the camera's own motion.
 *
 * Regions that elements upstream have found (#GstVideoRegionOfInterestMeta) raise or lower saliency
 * by `roi-weights`. `viewport=adaptive` lets the grid cover the part of the picture in which things
 * have lately happened. `max-cue-duration` and `cue-refractory` limit how long a tactor is felt and
 * how soon again.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileoverlay ! videoconvert ! autovideosink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile rows=4 columns=6 attach-saliency=true ! \
 *     tactileoverlay style=heatmap ! videoconvert ! autovideosink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile roi-weights="tactile-target=0.5" \
 *     viewport=adaptive max-cue-duration=1000000000 ! tactileoverlay ! videoconvert ! autovideosink
 * ]|
 *
 * ## Messages
 * - `saliencytactile-stats`: the contents of #GstSaliencyTactile:stats at the end of the stream.
 *
 * Since: 0.1
 */
#include "gstsaliencytactile.h"

#include "framemapping.h"
#include "regionsofinterest.h"
#include "saliency/analyzer.h"
#include "saliency/top_down_saliency.h"
#include "saliencysettings.h"
#include "tactile/cue_limiter.h"
#include "tactile/tactile_mapping.h"
#include "tactile/viewport.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

GST_DEBUG_CATEGORY_STATIC(saliency_tactile_debug);
#define GST_CAT_DEFAULT saliency_tactile_debug

#define ROI_WEIGHTS_FORM "write them as type=weight,type=weight, for example face=3,logo=0"

namespace {

struct Statistics
{
  guint64 frames = 0;   ///< passed through
  guint64 analysed = 0; ///< of these
  guint64 active = 0;   ///< frames with any level above zero
  GstClockTime busy = 0;
  GstClockTime longest = 0;
};

/// What an analyzer is made for.
struct Analysis
{
  ProfileName profile = ProfileName::tuned;
  bool temporal = true;

  bool operator==(const Analysis &) const = default;
};

saliency::Profile
make_profile(const Analysis &analysis)
{
  using saliency::Profile;
  if (analysis.profile == ProfileName::paper)
    return Profile::paper();
  return analysis.temporal ? Profile::tuned() : Profile::tuned_spatial();
}

tactile::MappingSettings
make_mapping(const SaliencySettings &settings)
{
  using tactile::MappingSettings;
  MappingSettings mapping = settings.profile == ProfileName::paper ? MappingSettings::paper()
                            : settings.temporal                    ? MappingSettings::tuned()
                                                : MappingSettings::tuned_spatial();
  mapping.threshold = settings.threshold;
  if (settings.floor >= 0)
    mapping.floor = settings.floor * mapping.units_per_delta_e;
  return mapping;
}

/// Time between two analyses; 0 without a limit.
saliency::Time
analysis_period(double max_rate)
{
  return saliency::Time(max_rate > 0 ? static_cast<gint64>(std::min(1e9 / max_rate, 1e15)) : 0);
}

} // namespace

struct GstSaliencyTactilePrivate
{
  SaliencySettings settings; ///< object lock
  Statistics stats;          ///< object lock

  // Streaming thread only.
  GstVideoInfo info;
  bool negotiated = false;
  Analysis analysis; ///< that the analyzer is made for
  std::optional<saliency::Analyzer> analyzer;
  std::optional<saliency::TopDownSaliency> top_down; ///< there when the analyzer is
  tactile::AdaptiveViewport viewport;
  tactile::TactileMap map; ///< of the last analysis
  tactile::CueLimiter limiter;
  std::vector<gfloat> saliency; ///< packed copy of the last saliency map
  guint saliency_width = 0;
  guint saliency_height = 0;
  gfloat saliency_floor = 0;
  std::optional<saliency::Time> next_analysis; ///< on max-rate's grid; none: the next frame
  saliency::Time last_time{ 0 };               ///< of the last frame
  saliency::Time next_time{ 0 };               ///< for frames without one
  bool warned_map = false;
  bool warned_size = false;
};

struct _GstSaliencyTactile
{
  GstBaseTransform parent;
  GstSaliencyTactilePrivate *priv;
};

#define gst_saliency_tactile_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstSaliencyTactile, gst_saliency_tactile, GST_TYPE_BASE_TRANSFORM,
                        GST_DEBUG_CATEGORY_INIT(saliency_tactile_debug, "saliencytactile", 0,
                                                "visual saliency to tactile maps"));
GST_ELEMENT_REGISTER_DEFINE(saliencytactile, "saliencytactile", GST_RANK_NONE,
                            GST_TYPE_SALIENCY_TACTILE);

#define SALIENCY_CAPS                                                                              \
  GST_VIDEO_CAPS_MAKE(FRAME_MAPPING_FORMATS)                                                       \
  "; " GST_VIDEO_CAPS_MAKE_WITH_FEATURES("ANY", FRAME_MAPPING_FORMATS)
static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(SALIENCY_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(SALIENCY_CAPS));

/* ---- analysis (streaming thread) ---- */

/// Forgets what went before: what comes does not follow it.
static void
gst_saliency_tactile_forget(GstSaliencyTactile *self)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  if (priv->analyzer) {
    priv->analyzer->reset();
    priv->top_down->reset();
  }
  priv->viewport.reset();
  priv->limiter.reset();
}

/// Time and duration of a frame on a time line that rises even where the film is played backwards.
static void
gst_saliency_tactile_times(GstSaliencyTactile *self, GstBuffer *buffer, saliency::Time &time,
                           saliency::Time &duration)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  const GstSegment &segment = GST_BASE_TRANSFORM(self)->segment;
  const GstVideoInfo &info = priv->info;

  GstClockTime length = GST_BUFFER_DURATION(buffer);
  if (!GST_CLOCK_TIME_IS_VALID(length))
    length = info.fps_n > 0 ? gst_util_uint64_scale_int(GST_SECOND, info.fps_d, info.fps_n)
                            : GST_SECOND / 30;
  duration = saliency::Time(static_cast<gint64>(std::min<GstClockTime>(length, 3600 * GST_SECOND)));

  // Beyond thirty years nothing overflows: such times are taken as that.
  constexpr GstClockTime kLatest = 1'000'000'000'000'000'000;
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  const saliency::Time shown(static_cast<gint64>(std::min(pts, kLatest)));
  if (!GST_CLOCK_TIME_IS_VALID(pts))
    time = priv->next_time;
  else
    time = segment.format == GST_FORMAT_TIME && segment.rate < 0 ? -shown : shown;
  priv->next_time = std::min(time, saliency::Time(static_cast<gint64>(kLatest))) + duration;
}

/// The saliency map as what detectors have found says that it counts.
static const cv::Mat &
gst_saliency_tactile_weigh(GstSaliencyTactile *self, const SaliencySettings &settings,
                           GstBuffer *buffer, const FrameMapping &mapping,
                           const saliency::Saliency &found, saliency::Time time)
{
  if (!settings.roi_weights)
    return found.map;
  const saliency::FrameView &frame = mapping.view();
  return self->priv->top_down->compute(
      found, { frame.width, frame.height },
      regions_of_interest(buffer, mapping.left(), mapping.top(), *settings.roi_weights), time);
}

static void
gst_saliency_tactile_analyse(GstSaliencyTactile *self, const SaliencySettings &settings,
                             GstBuffer *buffer, saliency::Time time, saliency::Time duration)
{
  GstSaliencyTactilePrivate *priv = self->priv;

  priv->saliency.clear();
  const FrameMapping mapping(priv->info, buffer);
  if (!mapping) {
    if (!priv->warned_map) {
      g_autoptr(GstCaps) caps = gst_video_info_to_caps(&priv->info);
      GST_ELEMENT_WARNING(self, RESOURCE, READ,
                          ("A frame could not be read; it is felt as nothing."),
                          ("expected %" GST_PTR_FORMAT " in readable memory", caps));
    }
    priv->warned_map = true;
    priv->map = tactile::TactileMap(settings.rows, settings.columns);
    return;
  }

  const saliency::Saliency &found
      = priv->analyzer->analyze(mapping.view(), time, duration, settings.temporal);
  if (found.cut) { // what has been found in the last shot is no longer there
    priv->top_down->reset();
    priv->viewport.reset();
  }
  const cv::Mat &saliency
      = gst_saliency_tactile_weigh(self, settings, buffer, mapping, found, time);
  const tactile::MappingSettings how = make_mapping(settings);
  const tactile::SaliencyView view{ .values = saliency.ptr<float>(),
                                    .width = saliency.cols,
                                    .height = saliency.rows,
                                    .stride = static_cast<std::ptrdiff_t>(saliency.step1()),
                                    .horizontal = { found.picture.x, found.picture.width },
                                    .vertical = { found.picture.y, found.picture.height } };
  tactile::Viewport viewport;
  if (settings.viewport == ViewportMode::adaptive)
    viewport = priv->viewport.follow(view, how.floor, how.threshold, time);
  else
    priv->viewport.reset();
  if (priv->map.rows != settings.rows || priv->map.columns != settings.columns)
    priv->map = tactile::TactileMap(settings.rows, settings.columns);
  tactile::map_saliency(view, how, priv->map, viewport);

  if (settings.attach_saliency) {
    priv->saliency_width = static_cast<guint>(view.width);
    priv->saliency_height = static_cast<guint>(view.height);
    priv->saliency_floor = static_cast<gfloat>(how.floor);
    for (int y = 0; y < view.height; y++)
      priv->saliency.insert(priv->saliency.end(), view.values + y * view.stride,
                            view.values + y * view.stride + view.width);
  }
}

/// Lets controlled properties have their values for the frame at hand.
static void
gst_saliency_tactile_sync_values(GstSaliencyTactile *self, GstBuffer *buffer)
{
  const GstSegment &segment = GST_BASE_TRANSFORM(self)->segment;
  if (segment.format != GST_FORMAT_TIME)
    return;
  const GstClockTime time
      = gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  if (GST_CLOCK_TIME_IS_VALID(time))
    gst_object_sync_values(GST_OBJECT(self), time);
}

/// Whether this frame is analysed under max-rate: the first one at or after each point of a regular
/// grid, which begins anew after a jump in time.
static bool
gst_saliency_tactile_is_due(GstSaliencyTactile *self, double max_rate, saliency::Time time)
{
  // Timestamps are rounded: a third of 100 ms, three times, falls short of it.
  constexpr saliency::Time kSameTime = std::chrono::milliseconds(1);
  GstSaliencyTactilePrivate *priv = self->priv;

  const bool back = time < std::exchange(priv->last_time, time);
  if (priv->next_analysis && !back && max_rate > 0 && time + kSameTime < *priv->next_analysis)
    return false;
  const saliency::Time period = analysis_period(max_rate);
  const bool on_grid = priv->next_analysis && !back && time - *priv->next_analysis < period;
  priv->next_analysis = (on_grid ? *priv->next_analysis : time) + period;
  return true;
}

static void
gst_saliency_tactile_attach_saliency(GstSaliencyTactile *self, const SaliencySettings &settings,
                                     GstBuffer *buffer)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  if (!settings.attach_saliency)
    priv->saliency.clear();
  if (priv->saliency.empty())
    return;
  if (std::max(priv->saliency_width, priv->saliency_height) <= GST_SALIENCY_MAX_SIDE)
    gst_buffer_add_saliency_meta(buffer, priv->saliency_width, priv->saliency_height,
                                 priv->saliency.data(), priv->saliency.size(),
                                 priv->saliency_floor);
  else if (!std::exchange(priv->warned_size, true))
    GST_ELEMENT_WARNING(self, STREAM, FORMAT, ("The saliency map is too large to be attached."),
                        ("expected sides of at most %d, got %u x %u", GST_SALIENCY_MAX_SIDE,
                         priv->saliency_width, priv->saliency_height));
}

/// Another frame has passed, with these levels; `spent` is what its analysis took, none if it was not analysed.
static void
gst_saliency_tactile_count(GstSaliencyTactile *self, std::span<const float> felt,
                           std::optional<GstClockTime> spent)
{
  GST_OBJECT_LOCK(self);
  Statistics &stats = self->priv->stats;
  stats.frames++;
  stats.analysed += spent ? 1 : 0;
  stats.active += std::ranges::any_of(felt, [](float level) { return level > 0; }) ? 1 : 0;
  stats.busy += spent.value_or(0);
  stats.longest = std::max(stats.longest, spent.value_or(0));
  GST_OBJECT_UNLOCK(self);
}

static GstFlowReturn
gst_saliency_tactile_transform_ip(GstBaseTransform *transform, GstBuffer *buffer)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);
  GstSaliencyTactilePrivate *priv = self->priv;

  if (!priv->negotiated)
    return GST_FLOW_NOT_NEGOTIATED;

  gst_saliency_tactile_sync_values(self, buffer);
  GST_OBJECT_LOCK(self);
  const SaliencySettings settings = priv->settings;
  GST_OBJECT_UNLOCK(self);

  // Backwards, sources and decoders mark frames that do follow each other in this order.
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) && transform->segment.rate > 0)
    gst_saliency_tactile_forget(self);

  if (const GstTactileMeta *own = gst_buffer_get_tactile_meta(buffer); own && settings.keep_maps) {
    gst_saliency_tactile_count(self, { own->levels, std::size_t{ own->rows } * own->columns }, {});
    return GST_FLOW_OK;
  }

  saliency::Time time;
  saliency::Time duration;
  gst_saliency_tactile_times(self, buffer, time, duration);

  const Analysis wanted{ settings.profile, settings.temporal };
  // Between two analyses the last map holds, unless it is for another grid or from another part of
  // the film.
  const bool fits = priv->map.rows == settings.rows && priv->map.columns == settings.columns
                    && priv->analyzer && priv->analysis == wanted;
  const bool analyse = !fits || gst_saliency_tactile_is_due(self, settings.max_rate, time);
  std::optional<GstClockTime> spent;
  if (analyse) {
    try {
      const GstClockTime begin = gst_util_get_timestamp();
      if (!priv->analyzer || priv->analysis != wanted) {
        priv->analysis = wanted;
        const saliency::Profile profile = make_profile(wanted);
        priv->top_down.emplace(profile, wanted.temporal);
        priv->analyzer.emplace(profile);
      }
      priv->analyzer->set_threads(settings.n_threads);
      const saliency::Time period = analysis_period(settings.max_rate);
      gst_saliency_tactile_analyse(self, settings, buffer, time, std::max(duration, period));
      spent = gst_util_get_timestamp() - begin;
    } catch (const std::exception &e) {
      GST_ELEMENT_ERROR(self, STREAM, FAILED, ("The film analysis failed."), ("%s", e.what()));
      return GST_FLOW_ERROR;
    }
  }

  tactile::TactileMap felt = priv->map;
  priv->limiter.limit(felt, time, settings.cue_limits);
  gst_buffer_add_tactile_meta(buffer, static_cast<guint>(felt.rows),
                              static_cast<guint>(felt.columns), felt.levels.data(),
                              felt.levels.size());
  gst_saliency_tactile_attach_saliency(self, settings, buffer);

  gst_saliency_tactile_count(self, felt.levels, spent);
  return GST_FLOW_OK;
}

/// The same memory in a buffer whose metas may be written.
static GstFlowReturn
gst_saliency_tactile_prepare_output_buffer(GstBaseTransform *, GstBuffer *input, GstBuffer **output)
{
  *output = gst_buffer_is_writable(input) ? input : gst_buffer_copy(input);
  return *output ? GST_FLOW_OK : GST_FLOW_ERROR;
}

static GstStructure *
gst_saliency_tactile_stats(GstSaliencyTactile *self)
{
  GST_OBJECT_LOCK(self);
  const Statistics stats = self->priv->stats;
  GST_OBJECT_UNLOCK(self);
  return gst_structure_new("application/x-saliency-stats", "frames", G_TYPE_UINT64, stats.frames,
                           "analysed", G_TYPE_UINT64, stats.analysed, "active", G_TYPE_UINT64,
                           stats.active, "analysis-mean", G_TYPE_UINT64,
                           stats.analysed ? stats.busy / stats.analysed : 0, "analysis-max",
                           G_TYPE_UINT64, stats.longest, nullptr);
}

/* ---- stream ---- */

static void
gst_saliency_tactile_reset(GstSaliencyTactile *self)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  gst_saliency_tactile_forget(self);
  priv->map = {};
  priv->saliency.clear();
  priv->next_analysis.reset();
  priv->next_time = saliency::Time(0);
}

static gboolean
gst_saliency_tactile_set_caps(GstBaseTransform *transform, GstCaps *incaps, GstCaps *)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);
  GstSaliencyTactilePrivate *priv = self->priv;

  priv->negotiated = gst_video_info_from_caps(&priv->info, incaps);
  if (!priv->negotiated) {
    GST_ERROR_OBJECT(self, "expected raw video with a size of at least 1 x 1, got %" GST_PTR_FORMAT,
                     incaps);
    return FALSE;
  }
  gst_saliency_tactile_reset(self);
  return TRUE;
}

static gboolean
gst_saliency_tactile_sink_event(GstBaseTransform *transform, GstEvent *event)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_SEGMENT:
  case GST_EVENT_FLUSH_STOP:
    gst_saliency_tactile_reset(self);
    break;
  case GST_EVENT_EOS: {
    GstStructure *stats = gst_saliency_tactile_stats(self);
    gst_structure_set_name(stats, "saliencytactile-stats");
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), stats));
    break;
  }
  default:
    break;
  }
  return GST_BASE_TRANSFORM_CLASS(parent_class)->sink_event(transform, event);
}

static gboolean
gst_saliency_tactile_start(GstBaseTransform *transform)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);
  GST_OBJECT_LOCK(self);
  const std::string weights_error = self->priv->settings.roi_weights_error;
  GST_OBJECT_UNLOCK(self);
  if (!weights_error.empty()) {
    GST_ELEMENT_ERROR(self, LIBRARY, SETTINGS,
                      ("roi-weights cannot be read: %s.", weights_error.c_str()),
                      (ROI_WEIGHTS_FORM));
    return FALSE;
  }
  self->priv->negotiated = false;
  self->priv->warned_map = self->priv->warned_size = false;
  self->priv->analyzer.reset();
  gst_saliency_tactile_reset(self);
  GST_OBJECT_LOCK(self);
  self->priv->stats = {};
  GST_OBJECT_UNLOCK(self);
  return TRUE;
}

static gboolean
gst_saliency_tactile_stop(GstBaseTransform *transform)
{
  GST_SALIENCY_TACTILE(transform)->priv->analyzer.reset();
  return TRUE;
}

/* ---- properties ---- */

static void
gst_saliency_tactile_set_property(GObject *object, guint id, const GValue *value, GParamSpec *pspec)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(object);
  GST_OBJECT_LOCK(object);
  const bool known = self->priv->settings.set(id, value);
  const std::string error = self->priv->settings.roi_weights_error;
  GST_OBJECT_UNLOCK(object);
  if (!known)
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
  if (id == SALIENCY_PROP_ROI_WEIGHTS && !error.empty())
    GST_ELEMENT_WARNING(self, LIBRARY, SETTINGS,
                        ("roi-weights stay as they were: %s.", error.c_str()), (ROI_WEIGHTS_FORM));
}

static void
gst_saliency_tactile_get_property(GObject *object, guint id, GValue *value, GParamSpec *pspec)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(object);
  if (id == SALIENCY_PROP_STATS) {
    g_value_take_boxed(value, gst_saliency_tactile_stats(self));
    return;
  }
  GST_OBJECT_LOCK(object);
  const bool known = self->priv->settings.get(id, value);
  GST_OBJECT_UNLOCK(object);
  if (!known)
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
}

static void
gst_saliency_tactile_finalize(GObject *object)
{
  delete GST_SALIENCY_TACTILE(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_saliency_tactile_class_init(GstSaliencyTactileClass *klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS(klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);
  GstBaseTransformClass *transform_class = GST_BASE_TRANSFORM_CLASS(klass);

  object_class->set_property = gst_saliency_tactile_set_property;
  object_class->get_property = gst_saliency_tactile_get_property;
  object_class->finalize = gst_saliency_tactile_finalize;
  SaliencySettings::install(object_class);

  gst_element_class_set_static_metadata(
      element_class, "Saliency to touch", "Filter/Analyzer/Video",
      "Finds what draws the eye and adds it to each frame as a tactile map (GstTactileMeta)",
      "The visuotactile authors");
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);

  transform_class->set_caps = gst_saliency_tactile_set_caps;
  transform_class->sink_event = gst_saliency_tactile_sink_event;
  transform_class->start = gst_saliency_tactile_start;
  transform_class->stop = gst_saliency_tactile_stop;
  transform_class->prepare_output_buffer = gst_saliency_tactile_prepare_output_buffer;
  transform_class->transform_ip = gst_saliency_tactile_transform_ip;
  // Passthrough leaves caps, ALLOCATION and pools to the neighbours; transform_ip still sees every
  // frame.
  transform_class->transform_ip_on_passthrough = TRUE;
}

static void
gst_saliency_tactile_init(GstSaliencyTactile *self)
{
  self->priv = new GstSaliencyTactilePrivate;
  gst_video_info_init(&self->priv->info);
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
}
