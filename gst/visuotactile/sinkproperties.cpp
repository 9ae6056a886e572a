// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sinkproperties.h"

#include "../cameramode.h"
#include "../peoplemode.h"
#include "../properties.h"
#include "../soundmode.h"
#include "sinkparts.h"
#include "videosinks.h"

#include <utility>

namespace {

/// The child to which a property is forwarded.
enum class Owner
{
  self,
  shown,    ///< the video sink, or kept for it
  both,     ///< the video sink and tactorsink
  seen,     ///< the video sink and saliencytactile
  analysis, ///< saliencytactile
  tactors,  ///< tactorsink
  joins,    ///< where the sound joins
};

/// Defaults of the children, which a test compares. The values themselves are kept by the children.
struct Defaults
{
  bool yes = true;
  bool no = false;
  gint64 none = 0;
  guint side = 3;
  double threshold = 0.5;
  double floor = -1;
  double sensitivity = 1;
  double density = 0;
  double max_rate = 0;
  double rate = 5;
  double intensity = 1;
  guint64 max_lead = 180 * GST_MSECOND;
  std::string driver = "auto";
  std::string unset;
  GstVideoOrientationMethod video_direction = GST_VIDEO_ORIENTATION_AUTO;
  PeopleMode people = PeopleMode::automatic;
  CameraMode camera = CameraMode::off;
  SoundMode sound = SoundMode::film;
};

std::optional<std::string>
write_empty(const Defaults &)
{
  return "";
}

void
read_nothing(Defaults &, const gchar *)
{
}

template <GType (*type)(), auto make_spec>
GParamSpec *
make(const properties::Property<Defaults> &self, GParamFlags flags, const Defaults &)
{
  return make_spec(self.name, nullptr, self.blurb, type(), flags);
}

using P = properties::Property<Defaults>;
using properties::kPlaying;
using properties::kReadable;
using properties::kReady;

struct Entry
{
  Owner owner;
  P property;
};

constexpr Entry kEntries[] = {
  { Owner::self,
    { "video-sink", "Video sink, from the next start on (unset: the best available one)", kReady,
      make<gst_element_get_type, g_param_spec_object>, nullptr, nullptr } },
  { Owner::both, P::flag("sync", "Synchronize picture and tactors with the clock", kPlaying,
                         PROPERTY_FIELD(yes)) },
  { Owner::both, P::flag("async", "Go asynchronously to PAUSED", kPlaying, PROPERTY_FIELD(yes)) },
  { Owner::both, P::number<gint64>("ts-offset", "Delay of picture and tactors in ns", kPlaying,
                                   PROPERTY_FIELD(none)) },
  { Owner::shown, P::flag("force-aspect-ratio", "Keep the picture's aspect ratio", kPlaying,
                          PROPERTY_FIELD(yes)) },
  { Owner::shown,
    P::flag("enable-last-sample", "Keep last-sample", kPlaying, PROPERTY_FIELD(yes)) },
  { Owner::shown,
    { "last-sample", "The frame on the screen", kReadable,
      make<gst_sample_get_type, g_param_spec_boxed>, nullptr, nullptr } },
  { Owner::analysis,
    P::number<guint>("rows", "Rows of the tactile map (unset: those of the device, or 3)", kPlaying,
                     PROPERTY_FIELD(side), P::Range{ 1, 64 }) },
  { Owner::analysis,
    P::number<guint>("columns", "Columns of the tactile map (unset: those of the device, or 3)",
                     kPlaying, PROPERTY_FIELD(side), P::Range{ 1, 64 }) },
  { Owner::analysis,
    P::number<gdouble>("threshold",
                       "Cells up to this share of the frame's strongest cell are silent", kPlaying,
                       PROPERTY_FIELD(threshold), P::Range{ 0, 1 }) },
  { Owner::analysis,
    P::number<gdouble>("floor", "Event contrast up to which a frame is silent (-1 = the profile's)",
                       kPlaying, PROPERTY_FIELD(floor), P::Range{ -1, 1000 }) },
  { Owner::analysis, P::number<gdouble>("sensitivity", "Factor on event contrast", kPlaying,
                                        PROPERTY_FIELD(sensitivity), P::Range{ 0.1, 10 }) },
  { Owner::analysis,
    P::number<gdouble>("density", "Largest share of the time with vibration (0 = any)", kPlaying,
                       PROPERTY_FIELD(density), P::Range{ 0, 1 }) },
  { Owner::analysis,
    P::text("roi-weights",
            "Factors on saliency inside GstVideoRegionOfInterestMeta, 0 to 10, as type=factor,...",
            kPlaying, PROPERTY_FIELD(unset)) },
  { Owner::analysis, P::choice("people", "Detect faces and prefer events in them", kPlaying,
                               PROPERTY_FIELD(people), people_mode_type) },
  { Owner::analysis, P::choice("camera", "Effect of a traveling camera", kPlaying,
                               PROPERTY_FIELD(camera), camera_mode_type) },
  { Owner::analysis, P::number<gdouble>("max-rate", "Frames to analyze per second (0 = all)",
                                        kPlaying, PROPERTY_FIELD(max_rate), P::Range{ 0, 1000 }) },
  { Owner::analysis,
    P::flag("skip-unchanged", "Analyze only a fraction of the frames until the picture changes",
            kPlaying, PROPERTY_FIELD(yes)) },
  { Owner::joins, P::choice("sound", "Profile of the sound, if the pipeline has a soundtactile",
                            kPlaying, PROPERTY_FIELD(sound), sound_mode_type) },
  { Owner::seen,
    P::choice("video-direction",
              "Rotation and flipping of the picture and of the grid (auto: by the orientation tag)",
              kPlaying, PROPERTY_FIELD(video_direction), gst_video_orientation_method_get_type) },
  { Owner::tactors,
    P::text("driver", "Driver: auto, firmata, seat, gamepad, bhaptics, intiface, simulator", kReady,
            PROPERTY_FIELD(driver)) },
  { Owner::tactors,
    P::text("device", "Device of the driver, as in tactorsink", kReady, PROPERTY_FIELD(unset)) },
  { Owner::tactors,
    P::number<gdouble>("rate", "Rate in Hz at which tactors may change (0 = with every map)",
                       kPlaying, PROPERTY_FIELD(rate), P::Range{ 0, 1000 }) },
  { Owner::tactors, P::number<gdouble>("intensity", "Factor on all levels", kPlaying,
                                       PROPERTY_FIELD(intensity), P::Range{ 0, 1 }) },
  { Owner::tactors, P::flag("mute", "All motors at zero, at once", kPlaying, PROPERTY_FIELD(no)) },
  { Owner::tactors,
    P::number<guint64>("max-lead",
                       "Longest time in ns by which a command is issued before its frame; the "
                       "whole pipeline is delayed by this time",
                       kReady, PROPERTY_FIELD(max_lead), P::Range{ 0, GST_SECOND }) },
  { Owner::tactors,
    P::parsed<write_empty, read_nothing>(
        "mapping", "Tactor of each cell, row by row, -1 for none, as in 2,1,0", kPlaying) },
  { Owner::tactors, P::text("trace-location", "CSV file to write, one line per command", kReady,
                            PROPERTY_FIELD(unset)) },
  { Owner::tactors, P::flag("realtime", "Real-time priority for the threads that drive motors",
                            kReady, PROPERTY_FIELD(yes)) },
  { Owner::tactors,
    P::flag("guardian", "Run a process that stops the motors if this one is killed or crashes",
            kReady, PROPERTY_FIELD(yes)) },
  { Owner::tactors, P::stats("actuation-stats", "Statistics of the tactors") },
};

} // namespace

static GstElement *
gst_visuotactile_sink_get_owner(GstVisuotactileSink *self, Owner whose)
{
  if (whose == Owner::joins)
    return self->branch ? GST_ELEMENT(gst_tactile_branch_get_sound(self->branch)) : nullptr;
  return whose == Owner::analysis || whose == Owner::seen ? self->analysis
                                                          : gst_visuotactile_sink_get_tactors(self);
}

static void
gst_visuotactile_sink_set_wanted(GstVisuotactileSink *self, GstElement *wanted)
{
  if (wanted)
    gst_object_ref_sink(wanted);
  GST_OBJECT_LOCK(self);
  std::swap(self->wanted, wanted);
  GST_OBJECT_UNLOCK(self);
  gst_clear_object(&wanted);
}

static void
gst_visuotactile_sink_set_shown(GstVisuotactileSink *self, const gchar *name, const GValue *value)
{
  GST_OBJECT_LOCK(self);
  gst_structure_set_value(self->settings, name, value);
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  if (shown)
    set_property_within(shown, name, value);
}

static void
gst_visuotactile_sink_set_property(GObject *object, guint id, const GValue *value,
                                   GParamSpec *pspec)
{
  auto *self = GST_VISUOTACTILE_SINK_CAST(object);
  const Owner whose = kEntries[id - 1].owner;

  if (whose == Owner::self)
    gst_visuotactile_sink_set_wanted(self, GST_ELEMENT(g_value_get_object(value)));
  if (whose == Owner::shown || whose == Owner::both || whose == Owner::seen)
    gst_visuotactile_sink_set_shown(self, pspec->name, value);
  GstElement *child = gst_visuotactile_sink_get_owner(self, whose);
  if (whose != Owner::self && whose != Owner::shown && child)
    g_object_set_property(G_OBJECT(child), pspec->name, value);
}

static void
gst_visuotactile_sink_get_property(GObject *object, guint id, GValue *value, GParamSpec *pspec)
{
  auto *self = GST_VISUOTACTILE_SINK_CAST(object);
  const Owner whose = kEntries[id - 1].owner;

  g_param_value_set_default(pspec, value);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  GstElement *child = gst_visuotactile_sink_get_owner(self, whose);
  if (whose == Owner::self) {
    GST_OBJECT_LOCK(self);
    g_value_set_object(value, self->wanted ? self->wanted : self->shown);
    GST_OBJECT_UNLOCK(self);
  } else if (whose == Owner::analysis || whose == Owner::tactors || whose == Owner::seen
             || whose == Owner::joins) {
    if (child)
      g_object_get_property(G_OBJECT(child), pspec->name, value);
  } else if (!shown || !get_property_within(shown, pspec->name, value)) {
    GST_OBJECT_LOCK(self);
    const GValue *set = gst_structure_get_value(self->settings, pspec->name);
    if (set)
      g_value_copy(set, value);
    GST_OBJECT_UNLOCK(self);
  }
}

void
gst_visuotactile_sink_install_properties(GObjectClass *klass)
{
  klass->set_property = gst_visuotactile_sink_set_property;
  klass->get_property = gst_visuotactile_sink_get_property;
  const Defaults defaults;
  guint id = 0;
  for (const Entry &entry : kEntries)
    g_object_class_install_property(klass, ++id, entry.property.make_spec(defaults));
}
