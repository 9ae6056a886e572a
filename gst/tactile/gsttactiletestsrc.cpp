// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactiletestsrc
 * @title: tactiletestsrc
 * @short_description: generates films of balls that appear, rest and move, with ground truth
 *
 * tactiletestsrc generates the two synthetic films of "Saliency-Driven Tactile Effect Authoring
 * for Real-Time Visuotactile Feedback" (Kim, Lee, Choi 2012, Section 5). In
 * `pattern=static-motion`, one or two balls appear, rest for more than a second and jump
 * elsewhere. In `pattern=dynamic-motion`, a ball moves at various speeds with sudden stalls. Both
 * begin with one second of gray and repeat after ten minutes.
 *
 * A picture depends only on the properties, its time stamp and its format: the film is the same at
 * any frame rate and after any seek. Seeking and reverse playback are supported. By default, the
 * film has the paper's 1000 × 1000 pixels at 30 frames per second. A variable frame rate (0/1) is
 * treated as 30.
 *
 * ## Ground truth
 * Each ball has a #GstVideoRegionOfInterestMeta of type `tactile-target`: the pixels that it
 * touches, inside the picture. Its parameter `tactile-target` has the fields
 * - `ball` (int): 0 or 1, in the order of drawing,
 * - `onset` (guint64): stream time in nanoseconds when this ball last appeared or started to move,
 * - `moving` (boolean): whether it moves at the time of the frame.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=300 ! videoconvert ! autovideosink
 * gst-launch-1.0 tactiletestsrc pattern=dynamic-motion seed=7 noise=2 num-buffers=300 ! \
 *     video/x-raw,width=640,height=360 ! saliencytactile ! tactileoverlay ! videoconvert ! \
 *     autovideosink
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactiletestsrc.h"

#include "../properties.h"
#include "filmpainter.h"
#include "gsttactileelements.h"
#include "tactile/synthetic_film.h"

#include <gst/video/video.h>

#include <algorithm>
#include <optional>

GST_DEBUG_CATEGORY_STATIC(tactile_test_src_debug);
#define GST_CAT_DEFAULT tactile_test_src_debug

namespace {

using tactile::FilmPattern;
using tactile::FilmSettings;

constexpr int kPaperSide = 1000; ///< pixels (paper, Section 5)
constexpr int kPaperRate = 30;   ///< frames per second

struct TestSrcSettings
{
  FilmSettings film;
  double noise = 0; ///< standard deviation, in 8-bit codes
  bool is_live = false;
};

struct Private
{
  TestSrcSettings settings; ///< object lock

  // Streaming thread, or while it is stopped.
  GstVideoInfo info{};
  std::optional<FilmPainter> painter;
  std::optional<tactile::SyntheticFilm> film;
  std::optional<tactile::SensorNoise> sensor_noise;
  FilmSettings film_settings;           ///< of film
  double film_noise = 0;                ///< of sensor_noise
  GstClockTime base = 0;                ///< time of frame 0
  gint64 frame = 0;                     ///< the next one
  std::optional<GstClockTime> start_at; ///< of a seek, until the frame rate is known
};

/// Time of frame `number`, without accumulated rounding.
GstClockTime
frame_time(const Private &priv, gint64 number)
{
  const gint n = GST_VIDEO_INFO_FPS_N(&priv.info);
  const gint d = GST_VIDEO_INFO_FPS_D(&priv.info);
  if (n == 0)
    return gst_util_uint64_scale_int(static_cast<guint64>(number), GST_SECOND, kPaperRate);
  return gst_util_uint64_scale(static_cast<guint64>(number), static_cast<guint64>(d) * GST_SECOND,
                               static_cast<guint64>(n));
}

/// The frame at `time`.
gint64
frame_at(const Private &priv, GstClockTime time)
{
  const gint n = GST_VIDEO_INFO_FPS_N(&priv.info);
  const gint d = GST_VIDEO_INFO_FPS_D(&priv.info);
  gint64 frame
      = static_cast<gint64>(n == 0 ? gst_util_uint64_scale_int(time, kPaperRate, GST_SECOND)
                                   : gst_util_uint64_scale(time, static_cast<guint64>(n),
                                                           static_cast<guint64>(d) * GST_SECOND));
  if (frame_time(priv, frame + 1) <= time) // frame times are rounded down
    frame++;
  return frame;
}

#define TEST_SRC_FORMATS "{ I420, GRAY8, RGB, BGRx, NV12 }"

GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE(TEST_SRC_FORMATS)));

} // namespace

struct _GstTactileTestSrc
{
  GstPushSrc parent;
  Private *priv;
};

#define gst_tactile_test_src_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileTestSrc, gst_tactile_test_src, GST_TYPE_PUSH_SRC,
                        GST_DEBUG_CATEGORY_INIT(tactile_test_src_debug, "tactiletestsrc", 0,
                                                "synthetic films with ground truth"));
GST_ELEMENT_REGISTER_DEFINE(tactiletestsrc, "tactiletestsrc", GST_RANK_NONE,
                            GST_TYPE_TACTILE_TEST_SRC);

static GType
pattern_type(void)
{
  static const GEnumValue values[] = {
    { static_cast<gint>(FilmPattern::static_motion), "Balls appear, rest and are elsewhere at once",
      "static-motion" },
    { static_cast<gint>(FilmPattern::dynamic_motion), "A ball moves around and stalls",
      "dynamic-motion" },
    { 0, nullptr, nullptr },
  };
  static const GType type = properties::register_enum("GstTactileTestSrcPattern", values);
  return type;
}

static GstCaps *
gst_tactile_test_src_fixate(GstBaseSrc *base, GstCaps *caps)
{
  caps = gst_caps_truncate(gst_caps_make_writable(caps));
  GstStructure *structure = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_nearest_int(structure, "width", kPaperSide);
  gst_structure_fixate_field_nearest_int(structure, "height", kPaperSide);
  gst_structure_fixate_field_nearest_fraction(structure, "framerate", kPaperRate, 1);
  if (gst_structure_has_field(structure, "pixel-aspect-ratio"))
    gst_structure_fixate_field_nearest_fraction(structure, "pixel-aspect-ratio", 1, 1);
  return GST_BASE_SRC_CLASS(parent_class)->fixate(base, caps);
}

static gboolean
gst_tactile_test_src_set_caps(GstBaseSrc *base, GstCaps *caps)
{
  Private *priv = GST_TACTILE_TEST_SRC(base)->priv;

  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) {
    GST_ERROR_OBJECT(base, "expected caps of raw video, got %" GST_PTR_FORMAT, caps);
    return FALSE;
  }
  // The film continues at the new rate.
  priv->base += frame_time(*priv, priv->frame);
  priv->frame = 0;
  priv->info = info;

  priv->painter = FilmPainter::make(info);
  if (!priv->painter)
    GST_ELEMENT_ERROR(base, RESOURCE, NO_SPACE_LEFT,
                      ("No memory for such large frames: set a smaller size in the caps."),
                      ("%" GST_PTR_FORMAT, caps));
  return priv->painter.has_value();
}

static gboolean
gst_tactile_test_src_decide_allocation(GstBaseSrc *base, GstQuery *query)
{
  const GstVideoInfo &info = GST_TACTILE_TEST_SRC(base)->priv->info;
  GstBufferPool *pool = nullptr;
  guint size = 0;
  guint min = 0;
  guint max = 0;
  const bool offered = gst_query_get_n_allocation_pools(query) > 0;
  if (offered)
    gst_query_parse_nth_allocation_pool(query, 0, &pool, &size, &min, &max);
  if (pool == nullptr)
    pool = gst_video_buffer_pool_new();
  size = std::max(size, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));

  GstCaps *caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  GstStructure *config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, size, min, max);
  if (gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr))
    gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_set_config(pool, config);

  if (offered)
    gst_query_set_nth_allocation_pool(query, 0, pool, size, min, max);
  else
    gst_query_add_allocation_pool(query, pool, size, min, max);
  gst_object_unref(pool);
  return GST_BASE_SRC_CLASS(parent_class)->decide_allocation(base, query);
}

static gboolean
gst_tactile_test_src_start(GstBaseSrc *base)
{
  Private *priv = GST_TACTILE_TEST_SRC(base)->priv;
  gst_video_info_init(&priv->info);
  priv->base = 0;
  priv->frame = 0;
  priv->start_at.reset();
  return TRUE;
}

static gboolean
gst_tactile_test_src_stop(GstBaseSrc *base)
{
  Private *priv = GST_TACTILE_TEST_SRC(base)->priv;
  priv->painter.reset();
  priv->film.reset();
  priv->sensor_noise.reset();
  return TRUE;
}

static gboolean
gst_tactile_test_src_is_seekable(GstBaseSrc *base)
{
  (void)base;
  return TRUE;
}

static gboolean
gst_tactile_test_src_do_seek(GstBaseSrc *base, GstSegment *segment)
{
  Private *priv = GST_TACTILE_TEST_SRC(base)->priv;
  if (segment->rate < 0 && !GST_CLOCK_TIME_IS_VALID(segment->stop)) {
    GST_WARNING_OBJECT(base, "playing backwards needs a stop position, or num-buffers");
    return FALSE;
  }
  segment->time = segment->start;
  priv->start_at = segment->position;
  return TRUE;
}

static gboolean
gst_tactile_test_src_query(GstBaseSrc *base, GstQuery *query)
{
  const Private *priv = GST_TACTILE_TEST_SRC(base)->priv;
  GstFormat format = GST_FORMAT_UNDEFINED;

  if (GST_QUERY_TYPE(query) == GST_QUERY_DURATION) {
    gst_query_parse_duration(query, &format, nullptr);
    GST_OBJECT_LOCK(base);
    const bool known = format == GST_FORMAT_TIME && base->num_buffers >= 0;
    if (known)
      gst_query_set_duration(query, format,
                             static_cast<gint64>(frame_time(*priv, base->num_buffers)));
    GST_OBJECT_UNLOCK(base);
    if (known)
      return TRUE;
  }
  return GST_BASE_SRC_CLASS(parent_class)->query(base, query);
}

static void
gst_tactile_test_src_get_times(GstBaseSrc *base, GstBuffer *buffer, GstClockTime *start,
                               GstClockTime *end)
{
  *start = *end = GST_CLOCK_TIME_NONE;
  if (gst_base_src_is_live(base)) {
    *start = GST_BUFFER_PTS(buffer);
    *end = GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer);
  }
}

/// Makes the film that the properties define, if they changed.
static void
update_film(GstTactileTestSrc *self)
{
  Private *priv = self->priv;
  GST_OBJECT_LOCK(self);
  const FilmSettings settings = priv->settings.film;
  const double noise = priv->settings.noise;
  GST_OBJECT_UNLOCK(self);

  if (!priv->film || priv->film_settings != settings || priv->film_noise != noise) {
    priv->film.emplace(settings);
    priv->film_settings = settings;
    priv->sensor_noise.reset();
    if (noise > 0)
      priv->sensor_noise.emplace(noise, settings.seed);
    priv->film_noise = noise;
  }
}

static GstFlowReturn
gst_tactile_test_src_fill(GstPushSrc *source, GstBuffer *buffer)
{
  auto *self = GST_TACTILE_TEST_SRC(source);
  Private *priv = self->priv;
  const bool backwards = GST_BASE_SRC(source)->segment.rate < 0;

  if (!priv->painter)
    return GST_FLOW_NOT_NEGOTIATED;
  if (priv->start_at) {
    const GstClockTime start = *priv->start_at;
    priv->base = 0;
    priv->frame = backwards && start > 0 ? frame_at(*priv, start - 1) : frame_at(*priv, start);
    priv->start_at.reset();
  }
  if (priv->frame < 0)
    return GST_FLOW_EOS;

  const GstClockTime time = priv->base + frame_time(*priv, priv->frame);
  gst_object_sync_values(GST_OBJECT(self), time);
  update_film(self);

  const std::chrono::nanoseconds film_time(static_cast<std::int64_t>(time));
  const std::vector<tactile::Ball> balls = priv->film->balls_at(
      film_time, GST_VIDEO_INFO_WIDTH(&priv->info), GST_VIDEO_INFO_HEIGHT(&priv->info));
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &priv->info, buffer, GST_MAP_WRITE)) {
    GST_ELEMENT_ERROR(self, RESOURCE, WRITE,
                      ("Can't write to the buffers that downstream provides."), (nullptr));
    return GST_FLOW_ERROR;
  }
  const bool painted = priv->painter->paint(
      &frame, balls, priv->sensor_noise ? &*priv->sensor_noise : nullptr, film_time);
  gst_video_frame_unmap(&frame);
  if (!painted) {
    GST_ELEMENT_ERROR(self, RESOURCE, NO_SPACE_LEFT, ("No memory to make a frame."), (nullptr));
    return GST_FLOW_ERROR;
  }

  for (const tactile::Ball &ball : balls)
    add_target(buffer, priv->info, ball);
  GST_BUFFER_PTS(buffer) = time;
  GST_BUFFER_DTS(buffer) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(buffer) = priv->base + frame_time(*priv, priv->frame + 1) - time;
  GST_BUFFER_OFFSET(buffer) = static_cast<guint64>(priv->frame);
  GST_BUFFER_OFFSET_END(buffer) = static_cast<guint64>(priv->frame) + 1;
  priv->frame += backwards ? -1 : 1;
  return GST_FLOW_OK;
}

using P = properties::Property<TestSrcSettings>;
using properties::kPlaying;
static constexpr P kProperties[] = {
  P::choice("pattern", "Film of the paper", kPlaying, PROPERTY_FIELD(film.pattern), pattern_type),
  P::number<guint>("seed", "Number of the film: same seed, same film", kPlaying,
                   PROPERTY_FIELD(film.seed)),
  P::number<gdouble>("noise", "Standard deviation of sensor noise on every sample, in 8-bit codes",
                     properties::kControllable, PROPERTY_FIELD(noise), P::Range{ 0, 32 }),
  P::number<gint>(
      "balls", "Number of balls (0 = as in the paper: one or two at random, one in dynamic-motion)",
      kPlaying, PROPERTY_FIELD(film.balls), P::Range{ 0, 2 }),
  P::number<gdouble>("ball-size", "Diameter of a ball as a share of the picture's width", kPlaying,
                     PROPERTY_FIELD(film.ball_size), P::Range{ 0.01, 0.5 }),
  P::flag("is-live", "Make each frame at its time, as a camera does", properties::kReady,
          PROPERTY_FIELD(is_live)),
};

static TestSrcSettings &
gst_tactile_test_src_settings(GObject *object)
{
  return GST_TACTILE_TEST_SRC(object)->priv->settings;
}

static void
gst_tactile_test_src_property_changed(GObject *object, std::string_view name)
{
  if (name != "is-live")
    return;
  GST_OBJECT_LOCK(object);
  const bool is_live = gst_tactile_test_src_settings(object).is_live;
  GST_OBJECT_UNLOCK(object);
  gst_base_src_set_live(GST_BASE_SRC(object), is_live);
}

static void
gst_tactile_test_src_finalize(GObject *object)
{
  delete GST_TACTILE_TEST_SRC(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_test_src_class_init(GstTactileTestSrcClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);
  auto *src_class = GST_BASE_SRC_CLASS(klass);
  object_class->finalize = gst_tactile_test_src_finalize;
  properties::install<TestSrcSettings>(
      object_class, kProperties,
      { gst_tactile_test_src_settings, gst_tactile_test_src_property_changed });

  src_class->fixate = GST_DEBUG_FUNCPTR(gst_tactile_test_src_fixate);
  src_class->set_caps = GST_DEBUG_FUNCPTR(gst_tactile_test_src_set_caps);
  src_class->decide_allocation = GST_DEBUG_FUNCPTR(gst_tactile_test_src_decide_allocation);
  src_class->start = GST_DEBUG_FUNCPTR(gst_tactile_test_src_start);
  src_class->stop = GST_DEBUG_FUNCPTR(gst_tactile_test_src_stop);
  src_class->is_seekable = GST_DEBUG_FUNCPTR(gst_tactile_test_src_is_seekable);
  src_class->do_seek = GST_DEBUG_FUNCPTR(gst_tactile_test_src_do_seek);
  src_class->query = GST_DEBUG_FUNCPTR(gst_tactile_test_src_query);
  src_class->get_times = GST_DEBUG_FUNCPTR(gst_tactile_test_src_get_times);
  GST_PUSH_SRC_CLASS(klass)->fill = GST_DEBUG_FUNCPTR(gst_tactile_test_src_fill);

  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile test source", "Source/Video",
      "Makes films of balls that appear, rest and move, with ground truth",
      "The visuotactile authors");
}

static void
gst_tactile_test_src_init(GstTactileTestSrc *self)
{
  self->priv = new Private;
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}
