// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliencysettings.h"

#include "tactile/tactile_map.h"

#include <utility>

namespace {

GType
profile_type()
{
  static const GEnumValue values[] = {
    { static_cast<gint>(ProfileName::tuned), "Events, but not cuts, fades, noise or camera motion",
      "tuned" },
    { static_cast<gint>(ProfileName::paper), "Kim, Lee, Choi 2012, taken literally", "paper" },
    { 0, nullptr, nullptr },
  };
  static const GType type = properties::register_enum("GstSaliencyTactileProfile", values);
  return type;
}

GType
viewport_type()
{
  static const GEnumValue values[] = {
    { static_cast<gint>(ViewportMode::fixed), "The whole picture", "fixed" },
    { static_cast<gint>(ViewportMode::adaptive), "The part with recent events", "adaptive" },
    { 0, nullptr, nullptr },
  };
  static const GType type = properties::register_enum("GstSaliencyTactileViewport", values);
  return type;
}

std::optional<std::string>
write_weights(const SaliencySettings &settings)
{
  if (!settings.roi_weights)
    return std::nullopt;
  return settings.roi_weights->text();
}

/// Text that cannot be read leaves the weights unchanged.
void
read_weights(SaliencySettings &settings, const gchar *text)
{
  settings.roi_weights_error.clear();
  if (!text) {
    settings.roi_weights = nullptr;
    return;
  }
  tl::expected<saliency::RegionWeights, std::string> weights = saliency::RegionWeights::parse(text);
  if (weights)
    settings.roi_weights = std::make_shared<const saliency::RegionWeights>(*std::move(weights));
  else
    settings.roi_weights_error = std::move(weights.error());
}

using P = properties::Property<SaliencySettings>;
using properties::kControllable;
using properties::kPlaying;
constexpr P::Range kGridSides{ tactile::kMinGridSide, tactile::kMaxGridSide };

constexpr P kProperties[] = {
  P::choice("profile", "Profile of the analysis", kPlaying, PROPERTY_FIELD(profile), profile_type),
  P::number<guint>("rows", "Rows of the tactile map (unset: those of the device, or 3)", kPlaying,
                   PROPERTY_FIELD(rows), kGridSides),
  P::number<guint>("columns", "Columns of the tactile map (unset: those of the device, or 3)",
                   kPlaying, PROPERTY_FIELD(columns), kGridSides),
  P::flag("temporal", "Analyze changes in time instead of still pictures", kControllable,
          PROPERTY_FIELD(temporal)),
  P::number<gdouble>("threshold",
                     "Cells up to this share of the frame's strongest cell are silent "
                     "(profile=paper: pixels, of the strongest pixel)",
                     kControllable, PROPERTY_FIELD(threshold), P::Range{ 0, 1 }),
  P::number<gdouble>("center-weight",
                     "Weight of the picture's center above that of its corners (-1 = the "
                     "profile's: 0.4, with temporal=false 0.7, with profile=paper 0)",
                     kControllable, PROPERTY_FIELD(center_weight),
                     P::Range{ SaliencySettings::kProfiles, 1 }),
  P::number<gdouble>(
      "floor", "Event contrast in CIE Delta E up to which a frame is silent (-1 = the profile's)",
      kControllable, PROPERTY_FIELD(floor), P::Range{ SaliencySettings::kProfiles, 1000 }),
  P::number<gdouble>("sensitivity",
                     "Factor on event contrast, for the floor and for the strength (profile=paper: "
                     "no effect without floor)",
                     kControllable, PROPERTY_FIELD(sensitivity), P::Range{ 0.1, 10 }),
  P::number<gdouble>("density",
                     "Largest share of the time with vibration: the floor rises, up to tenfold, to "
                     "keep it (0 = any)",
                     kControllable, PROPERTY_FIELD(density), P::Range{ 0, 1 }),
  P::parsed<write_weights, read_weights>("roi-weights",
                                         "Factors on saliency inside GstVideoRegionOfInterestMeta, "
                                         "0 to 10, as type=factor,...; type * is any other type",
                                         kPlaying),
  P::choice("people", "Detect faces and prefer events in them (profile=paper: no effect)", kPlaying,
            PROPERTY_FIELD(people), people_mode_type),
  P::choice("viewport", "Part of the picture that the grid covers", kPlaying,
            PROPERTY_FIELD(viewport), viewport_type),
  P::choice("camera", "Effect of a traveling camera (profile=paper: none)", kPlaying,
            PROPERTY_FIELD(camera), camera_mode_type),
  P::choice("video-direction",
            "Rotation and flipping of the picture, and with it of the grid, on the way to the "
            "screen (auto: by "
            "the orientation tag)",
            kPlaying, PROPERTY_FIELD(video_direction), gst_video_orientation_method_get_type),
  P::number<guint64>("max-cue-duration",
                     "Longest time in ns for which a cell vibrates without a break (0 = unlimited)",
                     kPlaying, PROPERTY_FIELD(cue_limits.max_duration)),
  P::number<guint64>("cue-refractory", "Time in ns for which a cell is silent after a cue",
                     kPlaying, PROPERTY_FIELD(cue_limits.refractory)),
  P::flag("attach-saliency", "Also add the saliency map, as a GstSaliencyMeta", kPlaying,
          PROPERTY_FIELD(attach_saliency)),
  P::number<gdouble>("max-rate",
                     "Frames to analyze per second; other frames repeat the last map (0 = all)",
                     kPlaying, PROPERTY_FIELD(max_rate), P::Range{ 0, 1000 }),
  P::flag("skip-unchanged", "Analyze only a fraction of the frames until the picture changes",
          kPlaying, PROPERTY_FIELD(skip_unchanged)),
  P::flag("keep-maps", "Do not analyze frames that already have a map", kPlaying,
          PROPERTY_FIELD(keep_maps)),
  P::number<guint>("n-threads", "Threads that work on a frame, with the same result (0: one)",
                   kPlaying, PROPERTY_FIELD(n_threads), P::Range{ 0, 64 }),
  P::flag("exact",
          "Convert the color of every pixel: several times the cost for hardly better maps",
          kPlaying, PROPERTY_FIELD(exact)),
  P::stats(
      "stats",
      "Frames passed, analyzed, unchanged (skipped) and active (any level above 0); faces in the "
      "last frame; times of analyses and of face detections in ns; path of the frames (mapped, gl, "
      "element, converted or none) and the bytes read from frames that were shrunk"),
};

} // namespace

void
SaliencySettings::install(GObjectClass *klass, const properties::Element<SaliencySettings> &element)
{
  properties::install<SaliencySettings>(klass, kProperties, element);
}
