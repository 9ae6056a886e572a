// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sinkproperties.h"

#include "../rangedproperty.h"
#include "gstvisuotactilesinkprivate.h"
#include "videosinks.h"

#include <gst/video/video.h>

#include <utility>

namespace {

/// Whose a property is.
enum class Owner
{
  analysis, ///< saliencytactile's
  tactors,  ///< tactorsink's
  shown,    ///< the video sink's, kept for it until there is one
  both,     ///< the video sink's and tactorsink's, likewise
  seen,     ///< the video sink's and saliencytactile's, likewise
  self,
};

enum Property : guint
{
  PROP_VIDEO_SINK = 1,
  PROP_SYNC,
  PROP_ASYNC,
  PROP_TS_OFFSET,
  PROP_FORCE_ASPECT_RATIO,
  PROP_ENABLE_LAST_SAMPLE,
  PROP_LAST_SAMPLE,
  PROP_ROWS,
  PROP_COLUMNS,
  PROP_THRESHOLD,
  PROP_FLOOR,
  PROP_ROI_WEIGHTS,
  PROP_MAX_RATE,
  PROP_VIDEO_DIRECTION,
  PROP_DRIVER,
  PROP_DEVICE,
  PROP_RATE,
  PROP_INTENSITY,
  PROP_MUTE,
  PROP_MAX_LEAD,
  PROP_MAPPING,
  PROP_TRACE_LOCATION,
  PROP_REALTIME,
  PROP_STATS,
};

Owner
owner(guint id)
{
  switch (id) {
  case PROP_VIDEO_SINK:
    return Owner::self;
  case PROP_SYNC:
  case PROP_ASYNC:
  case PROP_TS_OFFSET:
    return Owner::both;
  case PROP_FORCE_ASPECT_RATIO:
  case PROP_ENABLE_LAST_SAMPLE:
  case PROP_LAST_SAMPLE:
    return Owner::shown;
  case PROP_VIDEO_DIRECTION:
    return Owner::seen;
  default:
    return id < PROP_DRIVER ? Owner::analysis : Owner::tactors;
  }
}

} // namespace

static GstElement *
gst_visuotactile_sink_get_owner(GstVisuotactileSink *self, guint id)
{
  const Owner whose = owner(id);
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
  auto *self = GST_VISUOTACTILE_SINK(object);
  const Owner whose = owner(id);

  if (whose == Owner::self)
    gst_visuotactile_sink_set_wanted(self, GST_ELEMENT(g_value_get_object(value)));
  if (whose == Owner::shown || whose == Owner::both || whose == Owner::seen)
    gst_visuotactile_sink_set_shown(self, pspec->name, value);
  GstElement *child = gst_visuotactile_sink_get_owner(self, id);
  if (whose != Owner::self && whose != Owner::shown && child)
    g_object_set_property(G_OBJECT(child), pspec->name, value);
}

static void
gst_visuotactile_sink_get_property(GObject *object, guint id, GValue *value, GParamSpec *pspec)
{
  auto *self = GST_VISUOTACTILE_SINK(object);
  const Owner whose = owner(id);

  g_param_value_set_default(pspec, value);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  GstElement *child = gst_visuotactile_sink_get_owner(self, id);
  if (whose == Owner::self) {
    GST_OBJECT_LOCK(self);
    g_value_set_object(value, self->wanted ? self->wanted : self->shown);
    GST_OBJECT_UNLOCK(self);
  } else if (whose == Owner::analysis || whose == Owner::tactors || whose == Owner::seen) {
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

  const auto readable = static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS);
  const auto ready = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
                                              | GST_PARAM_MUTABLE_READY);
  const auto playing = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
                                                | GST_PARAM_MUTABLE_PLAYING);
  const auto install = [klass](Property id, GParamSpec *pspec) {
    g_object_class_install_property(klass, id, pspec);
  };

  install(PROP_VIDEO_SINK,
          g_param_spec_object("video-sink", "Video sink",
                              "What shows the film, from the next start on (unset: the video sink "
                              "of the highest rank that can be used)",
                              GST_TYPE_ELEMENT, ready));
  install(PROP_SYNC,
          g_param_spec_boolean("sync", "Sync", "Show and play on the clock", TRUE, playing));
  install(PROP_ASYNC,
          g_param_spec_boolean("async", "Async", "Go asynchronously to PAUSED", TRUE, playing));
  install(PROP_TS_OFFSET, g_param_spec_int64("ts-offset", "TS offset",
                                             "By how much later picture and tactors are, in ns",
                                             G_MININT64, G_MAXINT64, 0, playing));
  install(PROP_FORCE_ASPECT_RATIO,
          g_param_spec_boolean("force-aspect-ratio", "Force aspect ratio",
                               "Keep the picture's aspect ratio", TRUE, playing));
  install(PROP_ENABLE_LAST_SAMPLE,
          g_param_spec_boolean("enable-last-sample", "Enable last sample",
                               "Keep the frame that is shown in last-sample", TRUE, playing));
  install(PROP_LAST_SAMPLE,
          g_param_spec_boxed("last-sample", "Last sample", "The frame that is shown",
                             GST_TYPE_SAMPLE, readable));

  // Ranges and defaults are those of the children's own; a test compares them.
  install(PROP_ROWS, ranged::uint("rows", "Rows", "Rows of the tactile map", 1, 64, 3, playing));
  install(PROP_COLUMNS,
          ranged::uint("columns", "Columns", "Columns of the tactile map", 1, 64, 3, playing));
  install(PROP_THRESHOLD,
          ranged::real("threshold", "Threshold",
                       "Share of the frame's maximum saliency below which nothing is felt", 0, 1,
                       0.5, playing));
  install(PROP_FLOOR, ranged::real("floor", "Floor",
                                   "Event contrast in CIE Delta E up to which a frame is silent "
                                   "whatever its maximum (-1 = the profile's own)",
                                   -1, 1000, -1, playing));
  install(PROP_ROI_WEIGHTS,
          g_param_spec_string("roi-weights", "Region of interest weights",
                              "What saliency is multiplied by inside "
                              "GstVideoRegionOfInterestMeta, by their type (unset: 1 each)",
                              nullptr, playing));
  install(PROP_MAX_RATE, ranged::real("max-rate", "Maximum rate",
                                      "Analyze at most this many frames per second (0 = all)", 0,
                                      1000, 0, playing));
  install(PROP_VIDEO_DIRECTION,
          g_param_spec_enum("video-direction", "Video direction",
                            "How the picture is turned when it is shown, by the video sink if it "
                            "can, and the grid with it (auto: by the image-orientation tag)",
                            GST_TYPE_VIDEO_ORIENTATION_METHOD, GST_VIDEO_ORIENTATION_AUTO,
                            playing));
  install(PROP_DRIVER,
          g_param_spec_string("driver", "Driver",
                              "What drives the tactors: auto, firmata, seat, simulator", "auto",
                              ready));
  install(PROP_DEVICE,
          g_param_spec_string("device", "Device",
                              "Which board: its serial number or bus path (unset: the first that "
                              "answers)",
                              nullptr, ready));
  install(PROP_RATE, ranged::real("rate", "Rate",
                                  "How often the tactors may change, in Hz (0 = with every map)", 0,
                                  1000, 5, playing));
  install(PROP_INTENSITY,
          ranged::real("intensity", "Intensity", "Master intensity, a factor on all levels", 0, 1,
                       1, playing));
  install(PROP_MUTE,
          g_param_spec_boolean("mute", "Mute", "All motors at zero, at once", FALSE, playing));
  install(PROP_MAX_LEAD,
          ranged::uint("max-lead", "Max lead",
                       "Longest time in ms by which a motor is told before its frame is "
                       "shown; all of the pipeline is delayed by it and 10 ms",
                       0, 1000, 180, ready));
  install(PROP_MAPPING,
          g_param_spec_string("mapping", "Mapping",
                              "Tactor of each cell, row by row from the top left, -1 for none, as "
                              "in 2,1,0 (empty: cell i is tactor i)",
                              "", playing));
  install(PROP_TRACE_LOCATION,
          g_param_spec_string("trace-location", "Trace location",
                              "CSV file that gets one line a command (unset: none)", nullptr,
                              ready));
  install(PROP_REALTIME,
          g_param_spec_boolean("realtime", "Real-time",
                               "Threads that bring commands to the motors ask to run before others",
                               TRUE, ready));
  install(PROP_STATS,
          g_param_spec_boxed("actuation-stats", "Actuation statistics",
                             "What the tactors were told", GST_TYPE_STRUCTURE, readable));
}
