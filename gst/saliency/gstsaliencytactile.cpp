// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-saliencytactile
 * @title: saliencytactile
 * @short_description: finds what draws the eye and adds it to each frame as a tactile map
 *
 * saliencytactile adds a #GstTactileMeta to each frame: a grid of levels with the place and
 * strength of events. Pixels and memory do not change. By default, the grid is the one that
 * downstream prefers, such as that of tactorsink's device, or 3 × 3; #GstSaliencyTactile:rows and
 * #GstSaliencyTactile:columns override it. [Steering](../guide/steering.md) explains the
 * properties, [the algorithm](../design/algorithm.md) the computation.
 *
 * The map refers to the picture as viewers see it; regions of interest and #GstSaliencyMeta refer
 * to the pixels of the frame. After videoflip, which does not remove the orientation tag, set
 * `video-direction=identity`.
 *
 * The element reads frames in their own memory. The field `path` of #GstSaliencyTactile:stats has
 * the method:
 *
 * - `mapped`: the element maps the frame;
 * - `gl`: the GPU shrinks an OpenGL texture, and the element reads the small picture, at most 0.2
 *   MB of a 4K frame's 12 MB. With a software renderer, the element maps the frame instead;
 * - `element`: vapostproc shrinks VA and DMABuf memory, vaapipostproc VA surfaces;
 * - `converted`: GstVideoConverter shrinks and converts other raw formats;
 * - `none`: the frame cannot be read. It passes with an empty map, and the element posts one
 *   warning.
 *
 * `profile=paper` and `exact` read every pixel, which is slow in a GPU's memory.
 *
 * Unless `people` is off, a thread detects faces about once a second, and events in faces are
 * preferred.
 * Faces, heads and persons that an upstream detector marks with #GstVideoRegionOfInterestMeta
 * replace this detection. A face counts from 0.2 s of film time after its picture. The element
 * waits for a late result, so that every run gives the same track, unless the source is live or a
 * sink reports late frames (QoS). The detector is a separate module and needs Debian's
 * opencv-data; without them, faces are not detected, and the element posts a warning unless
 * `people` is auto.
 *
 * A frame that a decoder marks as corrupted (#GST_BUFFER_FLAG_CORRUPTED) has an empty map. Time
 * stamps that decrease by up to eight frames do not interrupt the analysis. Where time stamps do
 * not advance, as those of a GIF in GStreamer 1.22, the element posts one warning, and the analysis
 * goes by the frame rate.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileoverlay ! \
 *     videoconvert ! autovideosink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! \
 *     saliencytactile rows=4 columns=6 attach-saliency=true ! \
 *     tactileoverlay style=heatmap ! videoconvert ! autovideosink
 * gst-launch-1.0 filesrc location=FILM ! decodebin ! saliencytactile people=thorough ! \
 *     tactileoverlay ! videoconvert ! autovideosink
 * ]|
 *
 * ## Messages
 * - `saliencytactile-stats`: the fields of #GstSaliencyTactile:stats at the end of the stream.
 *
 * Since: 0.1
 */
#include "gstsaliencytactile.h"

#include "../latency.h"
#include "../tactile/wantedgrid.h"
#include "filmanalysis.h"
#include "framemapping.h"
#include "framereader.h"
#include "frametimes.h"
#include "gst/video/video_direction.h"
#include "gst/video/writable_frame.h"
#include "saliencysettings.h"
#include "saliencystatistics.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

GST_DEBUG_CATEGORY_STATIC(saliency_tactile_debug);
#define GST_CAT_DEFAULT saliency_tactile_debug

#define ROI_WEIGHTS_FORM "write them as type=weight,type=weight, for example face=3,logo=0"

struct GstSaliencyTactilePrivate
{
  explicit GstSaliencyTactilePrivate(GstElement *self) : reader(self)
  {
  }

  SaliencySettings settings;              ///< object lock
  SaliencyStatistics stats;               ///< object lock
  std::atomic<bool> late = false;         ///< frames come late downstream (QoS)
  std::atomic<bool> queries_grid = false; ///< of downstream, before the next frame

  // Streaming thread only.
  GstVideoInfo info;
  bool negotiated = false;
  FrameReader reader;
  FilmAnalysis analysis;
  OrientationTags tags;
  FrameTimes times;
  guint rows = 0; ///< of the grid that downstream prefers
  guint columns = 0;
  bool warned_map = false;
  bool warned_size = false;
  bool warned_people = false;
  bool live = false; ///< the source is
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

// A source with a choice takes a format that is read as it is.
#define SALIENCY_CAPS                                                                              \
  GST_VIDEO_CAPS_MAKE(FRAME_MAPPING_FORMATS)                                                       \
  "; " GST_VIDEO_CAPS_MAKE_WITH_FEATURES("ANY", FRAME_MAPPING_FORMATS) "; video/x-raw"             \
                                                                       "; video/x-raw(ANY)"
static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(SALIENCY_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(SALIENCY_CAPS));

/* ---- frames (streaming thread) ---- */

static void
gst_saliency_tactile_orient(GstSaliencyTactile *self, const SaliencySettings &settings)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  const tactile::Orientation orientation = orientation_of(settings.video_direction, priv->tags);
  if (priv->analysis.turn(orientation))
    GST_INFO_OBJECT(self, "the grid is %s, rows %s, columns %s",
                    orientation.transposed ? "transposed" : "not transposed",
                    orientation.mirrored_rows ? "mirrored" : "as stored",
                    orientation.mirrored_columns ? "mirrored" : "as stored");
}

/// Analyzes a frame. Throws if memory is out (see FilmAnalysis).
static void
gst_saliency_tactile_analyze(GstSaliencyTactile *self, const SaliencySettings &settings,
                             GstBuffer *buffer, saliency::Time time, saliency::Time duration)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  priv->analysis.wait_for_people(!priv->live && !priv->late);
  const GstVideoCropMeta *crop = gst_buffer_get_video_crop_meta(buffer);
  const int width
      = std::min(crop ? static_cast<int>(std::min<guint>(crop->width, G_MAXINT)) : G_MAXINT,
                 GST_VIDEO_INFO_WIDTH(&priv->info));
  const int height
      = std::min(crop ? static_cast<int>(std::min<guint>(crop->height, G_MAXINT)) : G_MAXINT,
                 GST_VIDEO_INFO_HEIGHT(&priv->info));
  const int halvings
      = width > 0 && height > 0 ? priv->analysis.halvings(settings, width, height) : 0;
  const std::optional<ReadFrame> frame = priv->reader.read(buffer, halvings);
  const bool read
      = priv->analysis.analyze(settings, frame ? &*frame : nullptr, buffer, time, duration);
  const std::string no_people = priv->analysis.people_failure();
  if (!no_people.empty() && settings.people == PeopleMode::automatic)
    GST_LOG_OBJECT(self, "faces are not detected: %s", no_people.c_str());
  else if (!no_people.empty() && !std::exchange(priv->warned_people, true))
    GST_ELEMENT_WARNING(
        self, RESOURCE, NOT_FOUND, ("Faces are not detected: %s.", no_people.c_str()),
        ("the film plays without detection; if something is missing, install OpenCV's object "
         "detection and its data, in Debian gstreamer1.0-visuotactile-people and opencv-data"));
  if (read || std::exchange(priv->warned_map, true))
    return;
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(GST_BASE_TRANSFORM_SINK_PAD(self));
  GST_ELEMENT_WARNING(self, RESOURCE, READ,
                      ("Frames cannot be read: they pass unchanged, with empty tactile maps."),
                      ("expected memory that can be mapped, or an element that shrinks it "
                       "(vapostproc), got %" GST_PTR_FORMAT,
                       caps));
}

static void
gst_saliency_tactile_attach_saliency(GstSaliencyTactile *self, const SaliencySettings &settings,
                                     GstBuffer *buffer)
{
  const FilmAnalysis::AttachedSaliency &saliency = self->priv->analysis.saliency();
  const std::vector<float> &values = saliency.map.values();
  if (!settings.attach_saliency || values.empty())
    return;
  const auto width = static_cast<guint>(saliency.map.width());
  const auto height = static_cast<guint>(saliency.map.height());
  if (std::max(width, height) <= GST_SALIENCY_MAX_SIDE)
    gst_buffer_add_saliency_meta(buffer, width, height, values.data(), values.size(),
                                 saliency.floor);
  else if (!std::exchange(self->priv->warned_size, true))
    GST_ELEMENT_WARNING(
        self, STREAM, FORMAT, ("The saliency map is too large to be attached."),
        ("expected sides of at most %d, got %u x %u", GST_SALIENCY_MAX_SIDE, width, height));
}

/// Counts a frame with these levels. `spent` is the time of its analysis; none if it was not
/// analyzed, as if `unchanged`.
static void
gst_saliency_tactile_count(GstSaliencyTactile *self, std::span<const float> felt,
                           std::optional<GstClockTime> spent, bool unchanged)
{
  const people::People::Statistics people = self->priv->analysis.people_statistics();
  GST_OBJECT_LOCK(self);
  SaliencyStatistics &stats = self->priv->stats;
  stats.people = people;
  stats.path = self->priv->reader.path();
  stats.bytes = self->priv->reader.bytes();
  stats.count(felt, spent);
  stats.unchanged += unchanged ? 1 : 0;
  GST_OBJECT_UNLOCK(self);
}

/// The settings, with the grid that downstream prefers unless the user has set one.
static SaliencySettings
gst_saliency_tactile_agree(GstSaliencyTactile *self)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  if (priv->queries_grid.exchange(false)) {
    wanted_grid_of_frames(GST_BASE_TRANSFORM_SRC_PAD(self), &priv->rows, &priv->columns);
    GST_DEBUG_OBJECT(self, "downstream prefers %u x %u", priv->rows, priv->columns);
  }
  GST_OBJECT_LOCK(self);
  SaliencySettings settings = priv->settings;
  GST_OBJECT_UNLOCK(self);
  if (!settings.has_grid) {
    settings.rows = static_cast<int>(priv->rows);
    settings.columns = static_cast<int>(priv->columns);
  }
  return settings;
}

static GstFlowReturn
gst_saliency_tactile_transform_ip(GstBaseTransform *transform, GstBuffer *buffer)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);
  GstSaliencyTactilePrivate *priv = self->priv;

  if (!priv->negotiated)
    return GST_FLOW_NOT_NEGOTIATED;

  properties::sync_values(self, transform->segment, GST_BUFFER_PTS(buffer));
  const SaliencySettings settings = gst_saliency_tactile_agree(self);

  // In reverse playback sources and decoders mark frames that do follow each other in this order.
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) && transform->segment.rate > 0)
    priv->analysis.forget();

  if (const GstTactileMeta *own = gst_buffer_get_tactile_meta(buffer); own && settings.keep_maps) {
    gst_saliency_tactile_count(self, { own->levels, std::size_t{ own->rows } * own->columns }, {},
                               false);
    return GST_FLOW_OK;
  }

  const auto [time, duration] = priv->times.of(buffer, priv->info, transform->segment);
  if (priv->times.stand())
    GST_ELEMENT_WARNING(self, STREAM, FORMAT,
                        ("The frames' times do not advance: sinks show them all at once, and "
                         "little is felt."),
                        ("expected times that rise from frame to frame, got %" GST_TIME_FORMAT
                         " for each; ffmpeg may convert the film, such as a GIF",
                         GST_TIME_ARGS(GST_BUFFER_PTS(buffer))));
  gst_saliency_tactile_orient(self, settings);

  // Pixels that a decoder invented for lost data are not felt. The history continues with the next
  // whole frame.
  const bool is_whole = !GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_CORRUPTED);
  // Between two analyses the last map holds, unless the grid changed or time jumped.
  std::optional<GstClockTime> spent;
  bool unchanged = false;
  if (is_whole && priv->analysis.is_due(settings, time)) {
    try {
      const GstClockTime begin = gst_util_get_timestamp();
      gst_saliency_tactile_analyze(self, settings, buffer, time, duration);
      unchanged = priv->analysis.unchanged();
      if (!unchanged)
        spent = gst_util_get_timestamp() - begin;
    } catch (const std::exception &e) { // out of memory: no other exception is thrown
      GST_ELEMENT_ERROR(self, RESOURCE, NO_SPACE_LEFT,
                        ("No memory to analyze such large frames: scale them down before."),
                        ("%s", e.what()));
      return GST_FLOW_ERROR;
    }
  }

  const tactile::TactileMap felt = priv->analysis.map(settings, !is_whole, time);
  GstTactileMeta *added = gst_buffer_add_tactile_meta(buffer, static_cast<guint>(felt.rows),
                                                      static_cast<guint>(felt.columns),
                                                      felt.levels.data(), felt.levels.size());
  gst_tactile_meta_set_video_direction(added, settings.video_direction == GST_VIDEO_ORIENTATION_AUTO
                                                  ? priv->tags.method()
                                                  : settings.video_direction);
  if (is_whole)
    gst_saliency_tactile_attach_saliency(self, settings, buffer);

  gst_saliency_tactile_count(self, felt.levels, spent, unchanged);
  return GST_FLOW_OK;
}

/// Same memory, writable metas.
static GstFlowReturn
gst_saliency_tactile_prepare_output_buffer(GstBaseTransform *, GstBuffer *input, GstBuffer **output)
{
  // The base class keeps a reference to the input unless it is the output.
  *output = gst_buffer_is_writable(input) ? input : writable_frame(gst_buffer_ref(input));
  return GST_FLOW_OK;
}

static GstStructure *
gst_saliency_tactile_stats(GObject *object)
{
  GST_OBJECT_LOCK(object);
  const SaliencyStatistics stats = GST_SALIENCY_TACTILE(object)->priv->stats;
  GST_OBJECT_UNLOCK(object);
  return stats.to_structure();
}

/* ---- stream ---- */

static void
gst_saliency_tactile_reset(GstSaliencyTactile *self)
{
  GstSaliencyTactilePrivate *priv = self->priv;
  priv->analysis.reset();
  priv->times.reset();
}

/// Size and frame rate of caps that GstVideoInfo does not support.
static void
gst_saliency_tactile_guess(GstSaliencyTactile *self, GstCaps *caps)
{
  GstVideoInfo &info = self->priv->info;
  const GstStructure *format = gst_caps_get_structure(caps, 0);
  gst_video_info_init(&info);
  gst_structure_get_int(format, "width", &info.width);
  gst_structure_get_int(format, "height", &info.height);
  gst_structure_get_fraction(format, "framerate", &info.fps_n, &info.fps_d);
}

static gboolean
gst_saliency_tactile_set_caps(GstBaseTransform *transform, GstCaps *incaps, GstCaps *)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);
  GstSaliencyTactilePrivate *priv = self->priv;

  // Frames of other caps, such as DMA_DRM before GStreamer 1.24, may be shrunk by an element.
  const bool parsed = gst_video_info_from_caps(&priv->info, incaps);
  if (!parsed)
    gst_saliency_tactile_guess(self, incaps);
  priv->negotiated = true;
  priv->queries_grid = true;
  priv->reader.set_caps(incaps, parsed ? &priv->info : nullptr);
  gst_saliency_tactile_reset(self);
  priv->live = latency::is_live(GST_BASE_TRANSFORM_SINK_PAD(transform));
  return TRUE;
}

/// A late frame does not wait for people, too. A device or a new neighbor may prefer another grid.
static gboolean
gst_saliency_tactile_src_event(GstBaseTransform *transform, GstEvent *event)
{
  if (GST_EVENT_TYPE(event) == GST_EVENT_QOS) {
    GstClockTimeDiff late = 0;
    gst_event_parse_qos(event, nullptr, nullptr, &late, nullptr);
    GST_SALIENCY_TACTILE(transform)->priv->late = late > 0;
  }
  if (is_grid_event(event) || GST_EVENT_TYPE(event) == GST_EVENT_RECONFIGURE)
    GST_SALIENCY_TACTILE(transform)->priv->queries_grid = true;
  if (is_grid_event(event)) {
    gst_event_unref(event);
    return TRUE;
  }
  return GST_BASE_TRANSFORM_CLASS(parent_class)->src_event(transform, event);
}

static gboolean
gst_saliency_tactile_sink_event(GstBaseTransform *transform, GstEvent *event)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(transform);

  self->priv->tags.follow(event);
  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_SEGMENT:
  case GST_EVENT_FLUSH_STOP:
    gst_saliency_tactile_reset(self);
    break;
  case GST_EVENT_EOS: {
    GstStructure *stats = gst_saliency_tactile_stats(G_OBJECT(self));
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
  self->priv->warned_map = self->priv->warned_size = self->priv->warned_people = false;
  self->priv->late = false;
  self->priv->analysis.stop();
  self->priv->times = {};
  gst_saliency_tactile_reset(self);
  GST_OBJECT_LOCK(self);
  self->priv->stats = {};
  GST_OBJECT_UNLOCK(self);
  return TRUE;
}

static gboolean
gst_saliency_tactile_stop(GstBaseTransform *transform)
{
  GstSaliencyTactilePrivate *priv = GST_SALIENCY_TACTILE(transform)->priv;
  priv->analysis.stop();
  priv->reader.stop();
  priv->tags.reset();
  return TRUE;
}

/* ---- properties ---- */

static SaliencySettings &
gst_saliency_tactile_settings(GObject *object)
{
  return GST_SALIENCY_TACTILE(object)->priv->settings;
}

static void
gst_saliency_tactile_property_changed(GObject *object, std::string_view name)
{
  GstSaliencyTactile *self = GST_SALIENCY_TACTILE(object);
  if (name == "rows" || name == "columns") {
    GST_OBJECT_LOCK(object);
    self->priv->settings.has_grid = true;
    GST_OBJECT_UNLOCK(object);
  }
  if (name != "roi-weights")
    return;
  GST_OBJECT_LOCK(object);
  const std::string error = self->priv->settings.roi_weights_error;
  GST_OBJECT_UNLOCK(object);
  if (!error.empty())
    GST_ELEMENT_WARNING(self, LIBRARY, SETTINGS,
                        ("roi-weights stay as they were: %s.", error.c_str()), (ROI_WEIGHTS_FORM));
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

  object_class->finalize = gst_saliency_tactile_finalize;
  SaliencySettings::install(object_class,
                            { gst_saliency_tactile_settings, gst_saliency_tactile_property_changed,
                              gst_saliency_tactile_stats });

  gst_element_class_set_static_metadata(
      element_class, "Saliency to touch", "Filter/Analyzer/Video",
      "Detects the events that draw the eye and adds a tactile map (GstTactileMeta) to each frame",
      "The visuotactile authors");
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);

  transform_class->set_caps = GST_DEBUG_FUNCPTR(gst_saliency_tactile_set_caps);
  transform_class->sink_event = GST_DEBUG_FUNCPTR(gst_saliency_tactile_sink_event);
  transform_class->src_event = GST_DEBUG_FUNCPTR(gst_saliency_tactile_src_event);
  transform_class->start = GST_DEBUG_FUNCPTR(gst_saliency_tactile_start);
  transform_class->stop = GST_DEBUG_FUNCPTR(gst_saliency_tactile_stop);
  transform_class->prepare_output_buffer
      = GST_DEBUG_FUNCPTR(gst_saliency_tactile_prepare_output_buffer);
  transform_class->transform_ip = GST_DEBUG_FUNCPTR(gst_saliency_tactile_transform_ip);
  // Passthrough leaves caps, ALLOCATION and pools to the neighbors; transform_ip still gets every
  // frame.
  transform_class->transform_ip_on_passthrough = TRUE;
}

static void
gst_saliency_tactile_init(GstSaliencyTactile *self)
{
  self->priv = new GstSaliencyTactilePrivate(GST_ELEMENT(self));
  gst_video_info_init(&self->priv->info);
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
}
