// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliencysettings.h"

#include "../rangedproperty.h"
#include "gst/video/video_direction.h"
#include "tactile/tactile_map.h"

#include <utility>

namespace {

#define GST_TYPE_SALIENCY_TACTILE_PROFILE (gst_saliency_tactile_profile_get_type())
GType
gst_saliency_tactile_profile_get_type(void)
{
  static const GEnumValue values[] = {
    { static_cast<gint>(ProfileName::tuned),
      "What measures best: events alone, not cuts, fades, noise or camera motion", "tuned" },
    { static_cast<gint>(ProfileName::paper), "Kim, Lee, Choi 2012, taken literally", "paper" },
    { 0, nullptr, nullptr },
  };
  static const GType type = g_enum_register_static("GstSaliencyTactileProfile", values);
  return type;
}

#define GST_TYPE_SALIENCY_TACTILE_VIEWPORT (gst_saliency_tactile_viewport_get_type())
GType
gst_saliency_tactile_viewport_get_type(void)
{
  static const GEnumValue values[] = {
    { static_cast<gint>(ViewportMode::fixed), "The whole picture", "fixed" },
    { static_cast<gint>(ViewportMode::adaptive),
      "The part of the picture in which things have lately happened", "adaptive" },
    { 0, nullptr, nullptr },
  };
  static const GType type = g_enum_register_static("GstSaliencyTactileViewport", values);
  return type;
}

/// Times beyond this, thirty years, are taken as that: sums of them do not overflow.
constexpr guint64 kLongest = 1'000'000'000'000'000'000;

constexpr guint kMostThreads = 64;

tactile::Time
time_from_value(const GValue *value)
{
  return tactile::Time(static_cast<gint64>(MIN(g_value_get_uint64(value), kLongest)));
}

void
time_to_value(tactile::Time time, GValue *value)
{
  g_value_set_uint64(value, static_cast<guint64>(time.count()));
}

} // namespace

void
SaliencySettings::install(GObjectClass *klass)
{
  const auto playing = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
                                                | GST_PARAM_MUTABLE_PLAYING);
  const auto controllable = static_cast<GParamFlags>(playing | GST_PARAM_CONTROLLABLE);
  const SaliencySettings defaults;

  g_object_class_install_property(klass, SALIENCY_PROP_PROFILE,
                                  g_param_spec_enum("profile", "Profile",
                                                    "How saliency is computed",
                                                    GST_TYPE_SALIENCY_TACTILE_PROFILE,
                                                    static_cast<gint>(defaults.profile), playing));
  g_object_class_install_property(klass, SALIENCY_PROP_ROWS,
                                  ranged::uint("rows", "Rows", "Rows of the tactile map",
                                               tactile::kMinGridSide, tactile::kMaxGridSide,
                                               static_cast<guint>(defaults.rows), playing));
  g_object_class_install_property(klass, SALIENCY_PROP_COLUMNS,
                                  ranged::uint("columns", "Columns", "Columns of the tactile map",
                                               tactile::kMinGridSide, tactile::kMaxGridSide,
                                               static_cast<guint>(defaults.columns), playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_TEMPORAL,
      g_param_spec_boolean("temporal", "Temporal",
                           "Feel what changes (spatiotemporal saliency) rather than what stands "
                           "out in a still picture (spatial saliency)",
                           defaults.temporal, controllable));
  g_object_class_install_property(
      klass, SALIENCY_PROP_THRESHOLD,
      ranged::real("threshold", "Threshold",
                   "Share of the frame's maximum saliency below which nothing is felt", 0, 1,
                   defaults.threshold, controllable));
  g_object_class_install_property(
      klass, SALIENCY_PROP_FLOOR,
      ranged::real("floor", "Floor",
                   "Event contrast in CIE Delta E up to which a frame is silent whatever "
                   "its maximum (-1 = the profile's own)",
                   kProfileFloor, 1000, defaults.floor, controllable));
  g_object_class_install_property(
      klass, SALIENCY_PROP_ROI_WEIGHTS,
      g_param_spec_string(
          "roi-weights", "Region of interest weights",
          "What saliency is multiplied by inside GstVideoRegionOfInterestMeta, by their type, 0 to "
          "10 each: type=weight,... with * for any other type (unset: 1 each)",
          nullptr, playing));
  g_object_class_install_property(klass, SALIENCY_PROP_VIEWPORT,
                                  g_param_spec_enum("viewport", "Viewport",
                                                    "The part of the picture that the grid covers",
                                                    GST_TYPE_SALIENCY_TACTILE_VIEWPORT,
                                                    static_cast<gint>(defaults.viewport), playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_VIDEO_DIRECTION,
      video_direction_spec(
          "How the picture is turned on its way from here to the screen, which the "
          "grid follows (auto: by the image-orientation tag; identity: it is "
          "shown as it is here)",
          playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_MAX_CUE_DURATION,
      g_param_spec_uint64("max-cue-duration", "Maximum cue duration",
                          "How long in ns a cell is felt without a break before it is silent until "
                          "it was at rest or something clearly stronger comes (0 = unlimited)",
                          0, G_MAXUINT64,
                          static_cast<guint64>(defaults.cue_limits.max_duration.count()), playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_CUE_REFRACTORY,
      g_param_spec_uint64("cue-refractory", "Cue refractory time",
                          "Time in ns after the end of a cue in which its cell is not felt again "
                          "(0 = none)",
                          0, G_MAXUINT64,
                          static_cast<guint64>(defaults.cue_limits.refractory.count()), playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_ATTACH_SALIENCY,
      g_param_spec_boolean("attach-saliency", "Attach saliency",
                           "Add the saliency map to each frame too, as a GstSaliencyMeta",
                           defaults.attach_saliency, playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_MAX_RATE,
      ranged::real(
          "max-rate", "Maximum rate",
          "Analyze at most this many frames per second; the others repeat the last map (0 = all)",
          0, 1000, defaults.max_rate, playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_KEEP_MAPS,
      g_param_spec_boolean(
          "keep-maps", "Keep maps",
          "Leave frames that carry a map already, such as a designer's, as they are",
          defaults.keep_maps, playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_N_THREADS,
      ranged::uint("n-threads", "Threads",
                   "Threads that work on a frame, which is felt the same with any number (0 = "
                   "by the frame's size and the processor)",
                   0, kMostThreads, static_cast<guint>(defaults.n_threads), playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_EXACT,
      g_param_spec_boolean("exact", "Exact",
                           "Take every pixel's color, at several times the cost, rather than that "
                           "of small areas; profile=paper always does, and the others for frames "
                           "of up to 480000 pixels",
                           defaults.exact, playing));
  g_object_class_install_property(
      klass, SALIENCY_PROP_STATS,
      g_param_spec_boxed("stats", "Statistics",
                         "Frames passed, analyzed and active (any level above 0); mean and longest "
                         "analysis time in ns",
                         GST_TYPE_STRUCTURE,
                         static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
  gst_type_mark_as_plugin_api(GST_TYPE_SALIENCY_TACTILE_PROFILE, static_cast<GstPluginAPIFlags>(0));
  gst_type_mark_as_plugin_api(GST_TYPE_SALIENCY_TACTILE_VIEWPORT,
                              static_cast<GstPluginAPIFlags>(0));
}

void
SaliencySettings::set_roi_weights(const gchar *text)
{
  roi_weights_error.clear();
  if (!text) {
    roi_weights = nullptr;
    return;
  }
  tl::expected<saliency::RegionWeights, std::string> weights = saliency::RegionWeights::parse(text);
  if (weights)
    roi_weights = std::make_shared<const saliency::RegionWeights>(*std::move(weights));
  else
    roi_weights_error = std::move(weights.error());
}

bool
SaliencySettings::set(guint id, const GValue *value)
{
  switch (id) {
  case SALIENCY_PROP_PROFILE:
    profile = static_cast<ProfileName>(g_value_get_enum(value));
    break;
  case SALIENCY_PROP_ROWS:
    rows = static_cast<int>(g_value_get_uint(value));
    break;
  case SALIENCY_PROP_COLUMNS:
    columns = static_cast<int>(g_value_get_uint(value));
    break;
  case SALIENCY_PROP_TEMPORAL:
    temporal = g_value_get_boolean(value);
    break;
  case SALIENCY_PROP_THRESHOLD:
    threshold = g_value_get_double(value);
    break;
  case SALIENCY_PROP_FLOOR:
    floor = g_value_get_double(value);
    break;
  case SALIENCY_PROP_ROI_WEIGHTS:
    set_roi_weights(g_value_get_string(value));
    break;
  case SALIENCY_PROP_VIEWPORT:
    viewport = static_cast<ViewportMode>(g_value_get_enum(value));
    break;
  case SALIENCY_PROP_VIDEO_DIRECTION:
    video_direction = static_cast<GstVideoOrientationMethod>(g_value_get_enum(value));
    break;
  case SALIENCY_PROP_MAX_CUE_DURATION:
    cue_limits.max_duration = time_from_value(value);
    break;
  case SALIENCY_PROP_CUE_REFRACTORY:
    cue_limits.refractory = time_from_value(value);
    break;
  case SALIENCY_PROP_ATTACH_SALIENCY:
    attach_saliency = g_value_get_boolean(value);
    break;
  case SALIENCY_PROP_MAX_RATE:
    max_rate = g_value_get_double(value);
    break;
  case SALIENCY_PROP_KEEP_MAPS:
    keep_maps = g_value_get_boolean(value);
    break;
  case SALIENCY_PROP_N_THREADS:
    n_threads = static_cast<int>(g_value_get_uint(value));
    break;
  case SALIENCY_PROP_EXACT:
    exact = g_value_get_boolean(value);
    break;
  default:
    return false;
  }
  return true;
}

bool
SaliencySettings::get(guint id, GValue *value) const
{
  switch (id) {
  case SALIENCY_PROP_PROFILE:
    g_value_set_enum(value, static_cast<gint>(profile));
    break;
  case SALIENCY_PROP_ROWS:
    g_value_set_uint(value, static_cast<guint>(rows));
    break;
  case SALIENCY_PROP_COLUMNS:
    g_value_set_uint(value, static_cast<guint>(columns));
    break;
  case SALIENCY_PROP_TEMPORAL:
    g_value_set_boolean(value, temporal);
    break;
  case SALIENCY_PROP_THRESHOLD:
    g_value_set_double(value, threshold);
    break;
  case SALIENCY_PROP_FLOOR:
    g_value_set_double(value, floor);
    break;
  case SALIENCY_PROP_ROI_WEIGHTS:
    g_value_set_string(value, roi_weights ? roi_weights->text().c_str() : nullptr);
    break;
  case SALIENCY_PROP_VIEWPORT:
    g_value_set_enum(value, static_cast<gint>(viewport));
    break;
  case SALIENCY_PROP_VIDEO_DIRECTION:
    g_value_set_enum(value, video_direction);
    break;
  case SALIENCY_PROP_MAX_CUE_DURATION:
    time_to_value(cue_limits.max_duration, value);
    break;
  case SALIENCY_PROP_CUE_REFRACTORY:
    time_to_value(cue_limits.refractory, value);
    break;
  case SALIENCY_PROP_ATTACH_SALIENCY:
    g_value_set_boolean(value, attach_saliency);
    break;
  case SALIENCY_PROP_MAX_RATE:
    g_value_set_double(value, max_rate);
    break;
  case SALIENCY_PROP_KEEP_MAPS:
    g_value_set_boolean(value, keep_maps);
    break;
  case SALIENCY_PROP_N_THREADS:
    g_value_set_uint(value, static_cast<guint>(n_threads));
    break;
  case SALIENCY_PROP_EXACT:
    g_value_set_boolean(value, exact);
    break;
  default:
    return false;
  }
  return true;
}
