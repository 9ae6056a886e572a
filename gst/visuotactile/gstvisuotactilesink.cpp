// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-visuotactilesink
 * @title: visuotactilesink
 * @short_description: a video sink that lets a chair be felt, for any player
 *
 * visuotactilesink shows a film as any video sink does, and plays what draws the eye in it on the
 * motors of a chair. Whatever takes a video sink takes it: the `video-sink` of playbin and playbin3,
 * `gst-play-1.0 --videosink`, GstPlay. With `GST_PLUGIN_FEATURE_RANK=visuotactilesink:MAX` in the
 * environment autovideosink chooses it, and so do players that know nothing of it.
 *
 * Inside are `saliencytactile` (child `analysis`), `tactileextractor`, a queue for pictures and one
 * for maps, the video sink and `tactorsink` (child `tactors`). Their properties that are not among
 * these are set as children's: `visuotactilesink analysis::profile=paper tactors::max-duty=0`.
 *
 * The picture is shown by #GstVisuotactileSink:video-sink or, where none is set, by the sink of the
 * highest rank that can be used. All of the pipeline is delayed by #GstVisuotactileSink:max-lead and 10
 * ms; the queue of pictures holds that much and 200 ms more. That is pictures in memory: upstream is
 * asked for as many more buffers.
 *
 * Whatever happens to the tactors, the film plays: if they cannot be used, a warning says why.
 * Frames in memory that cannot be read are shown and not felt, with one warning. GstVideoOverlay and
 * GstNavigation are those of the video sink.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! videoconvert ! visuotactilesink driver=simulator trace-location=commands.csv
 * gst-launch-1.0 playbin uri=file://FILM video-sink="visuotactilesink rows=2 columns=4"
 * ]|
 *
 * Since: 0.1
 */
#include "gstvisuotactilesink.h"

#include "tactilebranch.h"
#include "videosinks.h"

#include <gst/video/navigation.h>
#include <gst/video/video.h>
#include <gst/video/videooverlay.h>

#include <cmath>
#include <utility>

GST_DEBUG_CATEGORY_STATIC(visuotactile_sink_debug);
#define GST_CAT_DEFAULT visuotactile_sink_debug

namespace {

/// What planning and a wake-up take: data is asked for this much before max-lead, as tactorsink does.
constexpr GstClockTime kWakeMargin = 10 * GST_MSECOND;

/// What the queue of pictures holds beyond that.
constexpr GstClockTime kLookahead = 200 * GST_MSECOND;

/// Whose a property is.
enum class Owner
{
  analysis, ///< saliencytactile's
  tactors,  ///< tactorsink's
  shown,    ///< the video sink's, kept for it until there is one
  both,     ///< the video sink's and tactorsink's, likewise
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
  PROP_DRIVER,
  PROP_DEVICE,
  PROP_RATE,
  PROP_INTENSITY,
  PROP_MUTE,
  PROP_MAX_LEAD,
  PROP_MAPPING,
  PROP_TRACE_LOCATION,
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
  default:
    return id < PROP_DRIVER ? Owner::analysis : Owner::tactors;
  }
}

/// What the application wants of the video sink's window.
struct Window
{
  gboolean has_handle;
  guintptr handle;
  gboolean ignores_events;
  gboolean has_rectangle;
  GstVideoRectangle rectangle;
};

} // namespace

struct _GstVisuotactileSink
{
  GstBin parent;

  GstPad *sinkpad;
  GstElement *analysis; ///< NULL where an element is missing, as all of these
  GstElement *queue;
  GstTactileBranch *branch;
  GstElement *placeholder; ///< where the video sink will be; NULL while there is one

  /* Object lock. */
  GstElement *wanted;     ///< video-sink as set; owned
  GstElement *shown;      ///< the video sink that is in the bin; owned
  GstStructure *settings; ///< the video sink's properties, as far as they were set here
  Window window;
};

static void gst_visuotactile_sink_overlay_init(gpointer iface, gpointer);
static void gst_visuotactile_sink_navigation_init(gpointer iface, gpointer);
static void gst_visuotactile_sink_child_proxy_init(gpointer iface, gpointer);

#define gst_visuotactile_sink_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(
    GstVisuotactileSink, gst_visuotactile_sink, GST_TYPE_BIN,
    G_IMPLEMENT_INTERFACE(GST_TYPE_VIDEO_OVERLAY, gst_visuotactile_sink_overlay_init)
        G_IMPLEMENT_INTERFACE(GST_TYPE_NAVIGATION, gst_visuotactile_sink_navigation_init)
            G_IMPLEMENT_INTERFACE(GST_TYPE_CHILD_PROXY, gst_visuotactile_sink_child_proxy_init)
                GST_DEBUG_CATEGORY_INIT(visuotactile_sink_debug, "visuotactilesink", 0,
                                        "video sink with a chair"));
GST_ELEMENT_REGISTER_DEFINE(visuotactilesink, "visuotactilesink", GST_RANK_NONE,
                            GST_TYPE_VISUOTACTILE_SINK);

// Ordinary memory by itself, too: playbin counts the features that it has in common with a decoder, and knows no ANY.
static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw; video/x-raw(ANY)"));

static GstElement *
gst_visuotactile_sink_get_tactors(GstVisuotactileSink *self)
{
  return self->branch ? gst_tactile_branch_get_tactors(self->branch) : nullptr;
}

static GstElement *
gst_visuotactile_sink_ref_shown(GstVisuotactileSink *self)
{
  GST_OBJECT_LOCK(self);
  GstElement *shown = self->shown ? GST_ELEMENT(gst_object_ref(self->shown)) : nullptr;
  GST_OBJECT_UNLOCK(self);
  return shown;
}

/// How much earlier than the picture tactorsink asks for its maps.
static GstClockTime
gst_visuotactile_sink_lead(GstVisuotactileSink *self)
{
  guint max_lead = 0;
  g_object_get(gst_visuotactile_sink_get_tactors(self), "max-lead", &max_lead, nullptr);
  return max_lead * GST_MSECOND + kWakeMargin;
}

/* ---- window ---- */

/// What implements the interface in the video sink, or NULL; transfer full.
static GstElement *
gst_visuotactile_sink_ref_overlay(GstVisuotactileSink *self)
{
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  return shown ? find_interface_within(shown, GST_TYPE_VIDEO_OVERLAY) : nullptr;
}

static void
gst_visuotactile_sink_set_window_handle(GstVideoOverlay *overlay, guintptr handle)
{
  auto *self = GST_VISUOTACTILE_SINK(overlay);
  GST_OBJECT_LOCK(self);
  self->window.has_handle = TRUE;
  self->window.handle = handle;
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(self);
  if (shown)
    gst_video_overlay_set_window_handle(GST_VIDEO_OVERLAY(shown), handle);
}

static void
gst_visuotactile_sink_set_render_rectangle(GstVideoOverlay *overlay, gint x, gint y, gint width,
                                           gint height)
{
  auto *self = GST_VISUOTACTILE_SINK(overlay);
  GST_OBJECT_LOCK(self);
  self->window.has_rectangle = TRUE;
  self->window.rectangle = { x, y, width, height };
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(self);
  if (shown)
    gst_video_overlay_set_render_rectangle(GST_VIDEO_OVERLAY(shown), x, y, width, height);
}

static void
gst_visuotactile_sink_handle_events(GstVideoOverlay *overlay, gboolean handle_events)
{
  auto *self = GST_VISUOTACTILE_SINK(overlay);
  GST_OBJECT_LOCK(self);
  self->window.ignores_events = !handle_events;
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(self);
  if (shown)
    gst_video_overlay_handle_events(GST_VIDEO_OVERLAY(shown), handle_events);
}

static void
gst_visuotactile_sink_expose(GstVideoOverlay *overlay)
{
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(GST_VISUOTACTILE_SINK(overlay));
  if (shown)
    gst_video_overlay_expose(GST_VIDEO_OVERLAY(shown));
}

static void
gst_visuotactile_sink_overlay_init(gpointer iface, gpointer)
{
  auto *overlay = static_cast<GstVideoOverlayInterface *>(iface);
  overlay->set_window_handle = gst_visuotactile_sink_set_window_handle;
  overlay->set_render_rectangle = gst_visuotactile_sink_set_render_rectangle;
  overlay->handle_events = gst_visuotactile_sink_handle_events;
  overlay->expose = gst_visuotactile_sink_expose;
}

/// What was asked for before there was a video sink.
static void
gst_visuotactile_sink_apply_window(GstVisuotactileSink *self, GstElement *shown)
{
  g_autoptr(GstElement) element = find_interface_within(shown, GST_TYPE_VIDEO_OVERLAY);
  GST_OBJECT_LOCK(self);
  const Window window = self->window;
  GST_OBJECT_UNLOCK(self);
  if (element == nullptr)
    return;
  GstVideoOverlay *overlay = GST_VIDEO_OVERLAY(element);
  if (window.has_handle)
    gst_video_overlay_set_window_handle(overlay, window.handle);
  if (window.has_rectangle)
    gst_video_overlay_set_render_rectangle(overlay, window.rectangle.x, window.rectangle.y,
                                           window.rectangle.w, window.rectangle.h);
  if (window.ignores_events)
    gst_video_overlay_handle_events(overlay, FALSE);
}

/// To the video sink, which knows where on its window the picture is, else upstream as it is.
static void
gst_visuotactile_sink_send_navigation(GstNavigation *navigation, GstEvent *event)
{
  auto *self = GST_VISUOTACTILE_SINK(navigation);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  g_autoptr(GstElement) inner = shown ? find_interface_within(shown, GST_TYPE_NAVIGATION) : nullptr;
  if (inner)
    gst_navigation_send_event_simple(GST_NAVIGATION(inner), event);
  else
    gst_pad_push_event(self->sinkpad, event);
}

static void
gst_visuotactile_sink_navigation_init(gpointer iface, gpointer)
{
  auto *navigation = static_cast<GstNavigationInterface *>(iface);
  navigation->send_event_simple = gst_visuotactile_sink_send_navigation;
}

/* ---- the video sink ---- */

static gboolean
set_within(GQuark name, const GValue *value, gpointer element)
{
  set_property_within(GST_ELEMENT(element), g_quark_to_string(name), value);
  return TRUE;
}

static GstElement *
gst_visuotactile_sink_choose(GstVisuotactileSink *self)
{
  g_autoptr(GString) errors = g_string_new(nullptr);
  GstElement *chosen = choose_video_sink("video-sink", errors);
  if (chosen == nullptr) {
    GST_ELEMENT_WARNING(self, RESOURCE, NOT_FOUND,
                        ("No video sink can be used: the film is felt and not shown."),
                        ("%s", errors->len > 0 ? errors->str : "no video sink has a rank"));
    chosen = gst_element_factory_make("fakesink", "video-sink");
    g_object_set(chosen, "sync", TRUE, nullptr);
  }
  return chosen;
}

/// Takes the place of the video sink while there is none: a bin around this one would take a pad without
/// a peer for one of its own (gst_parse_bin_from_description()).
static void
gst_visuotactile_sink_add_placeholder(GstVisuotactileSink *self)
{
  self->placeholder = gst_element_factory_make("fakesink", "placeholder");
  gst_bin_add(GST_BIN(self), self->placeholder);
  gst_element_link(self->queue, self->placeholder);
}

static void
gst_visuotactile_sink_remove_placeholder(GstVisuotactileSink *self)
{
  gst_element_set_state(self->placeholder, GST_STATE_NULL);
  gst_bin_remove(GST_BIN(self), self->placeholder);
  self->placeholder = nullptr;
}

static void
gst_visuotactile_sink_remove_shown(GstVisuotactileSink *self)
{
  GST_OBJECT_LOCK(self);
  GstElement *shown = self->shown;
  self->shown = nullptr;
  GST_OBJECT_UNLOCK(self);
  if (shown == nullptr)
    return;
  gst_element_set_state(shown, GST_STATE_NULL);
  if (gst_object_has_as_parent(GST_OBJECT(shown), GST_OBJECT(self)))
    gst_bin_remove(GST_BIN(self), shown);
  gst_object_unref(shown);
  gst_visuotactile_sink_add_placeholder(self);
}

/// NULL to READY: the video sink that is wanted, or the best there is.
static gboolean
gst_visuotactile_sink_open(GstVisuotactileSink *self)
{
  if (self->branch == nullptr) {
    GST_ELEMENT_ERROR(self, CORE, MISSING_PLUGIN,
                      ("visuotactilesink needs saliencytactile, tactileextractor and tactorsink."),
                      ("expected the plugins saliency, tactile and tactor beside this one"));
    return FALSE;
  }
  GST_OBJECT_LOCK(self);
  GstElement *shown = self->wanted ? GST_ELEMENT(gst_object_ref(self->wanted)) : nullptr;
  GST_OBJECT_UNLOCK(self);
  if (shown == nullptr)
    shown = GST_ELEMENT(gst_object_ref_sink(gst_visuotactile_sink_choose(self)));

  GST_OBJECT_LOCK(self);
  self->shown = shown; // takes the reference
  g_autoptr(GstStructure) settings = gst_structure_copy(self->settings);
  GST_OBJECT_UNLOCK(self);
  gst_structure_foreach(settings, set_within, shown);
  gst_visuotactile_sink_apply_window(self, shown);
  gst_visuotactile_sink_remove_placeholder(self);
  if (!gst_bin_add(GST_BIN(self), shown) || !gst_element_link(self->queue, shown)) {
    GST_ELEMENT_ERROR(self, LIBRARY, SETTINGS, ("The video sink cannot be used."),
                      ("%s is in another bin or takes no video", GST_OBJECT_NAME(shown)));
    return FALSE;
  }
  GST_INFO_OBJECT(self, "shown by %" GST_PTR_FORMAT, shown);
  return TRUE;
}

static GstStateChangeReturn
gst_visuotactile_sink_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_VISUOTACTILE_SINK(element);
  GstStateChangeReturn ret = GST_STATE_CHANGE_FAILURE;

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) {
    const GstClockTime lookahead = gst_visuotactile_sink_lead(self) + kLookahead;
    g_object_set(self->queue, "max-size-time", lookahead, nullptr);
  }
  if (transition != GST_STATE_CHANGE_NULL_TO_READY || gst_visuotactile_sink_open(self))
    ret = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_READY_TO_NULL
      || (transition == GST_STATE_CHANGE_NULL_TO_READY && ret == GST_STATE_CHANGE_FAILURE))
    gst_visuotactile_sink_remove_shown(self);
  return ret;
}

/* ---- stream ---- */

/// Upstream has to have as many more buffers as wait here for their motors.
static void
gst_visuotactile_sink_raise_buffers(GstVisuotactileSink *self, GstQuery *query)
{
  GstCaps *caps = nullptr;
  GstVideoInfo info;
  gst_query_parse_allocation(query, &caps, nullptr);
  if (caps == nullptr || !gst_video_info_from_caps(&info, caps))
    return;
  const double fps = info.fps_n > 0 ? static_cast<double>(info.fps_n) / info.fps_d : 30.0;
  const double lead = static_cast<double>(gst_visuotactile_sink_lead(self)) / GST_SECOND;
  const guint more = static_cast<guint>(MIN(std::ceil(lead * fps) + 1, 256.0));

  const guint pools = gst_query_get_n_allocation_pools(query);
  if (pools == 0)
    gst_query_add_allocation_pool(query, nullptr, static_cast<guint>(MIN(info.size, G_MAXUINT)),
                                  more, 0);
  for (guint i = 0; i < pools; i++) {
    g_autoptr(GstBufferPool) pool = nullptr;
    guint size = 0;
    guint min = 0;
    guint max = 0;
    gst_query_parse_nth_allocation_pool(query, i, &pool, &size, &min, &max);
    gst_query_set_nth_allocation_pool(query, i, pool, size, min + more, max > 0 ? max + more : 0);
  }
}

static gboolean
gst_visuotactile_sink_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  const gboolean answered = gst_pad_query_default(pad, parent, query);
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION)
    return answered;
  // Also for a video sink that has no wishes of its own.
  gst_visuotactile_sink_raise_buffers(GST_VISUOTACTILE_SINK(parent), query);
  return TRUE;
}

/* ---- properties ---- */

/// By name children are found wherever they are, tactorsink also while it is out of its branch.
static GObject *
gst_visuotactile_sink_get_child_by_name(GstChildProxy *proxy, const gchar *name)
{
  auto *self = GST_VISUOTACTILE_SINK(proxy);
  GstElement *tactors = gst_visuotactile_sink_get_tactors(self);
  if (tactors && g_strcmp0(name, "tactors") == 0)
    return G_OBJECT(gst_object_ref(tactors));
  GstElement *child = gst_bin_get_by_name(GST_BIN(self), name);
  return child ? G_OBJECT(child) : nullptr;
}

static void
gst_visuotactile_sink_child_proxy_init(gpointer iface, gpointer)
{
  // Children by number are the bin's.
  static_cast<GstChildProxyInterface *>(iface)->get_child_by_name
      = gst_visuotactile_sink_get_child_by_name;
}

static GstElement *
gst_visuotactile_sink_get_owner(GstVisuotactileSink *self, guint id)
{
  return owner(id) == Owner::analysis ? self->analysis : gst_visuotactile_sink_get_tactors(self);
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
  if (whose == Owner::shown || whose == Owner::both)
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
  } else if (whose == Owner::analysis || whose == Owner::tactors) {
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

static void
gst_visuotactile_sink_dispose(GObject *object)
{
  auto *self = GST_VISUOTACTILE_SINK(object);
  gst_visuotactile_sink_remove_shown(self);
  gst_clear_object(&self->wanted);
  G_OBJECT_CLASS(parent_class)->dispose(object);
}

static void
gst_visuotactile_sink_finalize(GObject *object)
{
  gst_structure_free(GST_VISUOTACTILE_SINK(object)->settings);
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
install_properties(GObjectClass *klass)
{
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
  install(PROP_ROWS,
          g_param_spec_uint("rows", "Rows", "Rows of the tactile map", 1, 64, 3, playing));
  install(PROP_COLUMNS,
          g_param_spec_uint("columns", "Columns", "Columns of the tactile map", 1, 64, 3, playing));
  install(PROP_THRESHOLD,
          g_param_spec_double("threshold", "Threshold",
                              "Share of the frame's maximum saliency below which nothing is felt",
                              0, 1, 0.5, playing));
  install(PROP_FLOOR,
          g_param_spec_double("floor", "Floor",
                              "Event contrast in CIE Delta E up to which a frame is silent "
                              "whatever its maximum (-1 = the profile's own)",
                              -1, 1000, -1, playing));
  install(PROP_ROI_WEIGHTS,
          g_param_spec_string("roi-weights", "Region of interest weights",
                              "What saliency is multiplied by inside "
                              "GstVideoRegionOfInterestMeta, by their type (unset: 1 each)",
                              nullptr, playing));
  install(PROP_MAX_RATE,
          g_param_spec_double("max-rate", "Maximum rate",
                              "Analyse at most this many frames per second (0 = all)", 0, 1000, 0,
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
  install(PROP_RATE,
          g_param_spec_double("rate", "Rate",
                              "How often the tactors may change, in Hz (0 = with every map)", 0,
                              1000, 5, playing));
  install(PROP_INTENSITY,
          g_param_spec_double("intensity", "Intensity", "Master intensity, a factor on all levels",
                              0, 1, 1, playing));
  install(PROP_MUTE,
          g_param_spec_boolean("mute", "Mute", "All motors at zero, at once", FALSE, playing));
  install(PROP_MAX_LEAD,
          g_param_spec_uint("max-lead", "Max lead",
                            "Longest time in ms by which a motor is told before its frame is "
                            "shown; all of the pipeline is delayed by it and 10 ms",
                            0, 1000, 180, ready));
  install(
      PROP_MAPPING,
      gst_param_spec_array(
          "mapping", "Mapping",
          "Tactor of each cell, row by row from the top left, -1 for none "
          "(empty: cell i is tactor i)",
          g_param_spec_int("tactor", "Tactor", "Index of a tactor, -1 for none", -1, 4095, 0,
                           static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS)),
          playing));
  install(PROP_TRACE_LOCATION,
          g_param_spec_string("trace-location", "Trace location",
                              "CSV file that gets one line a command (unset: none)", nullptr,
                              ready));
  install(PROP_STATS, g_param_spec_boxed("stats", "Statistics", "What the tactors were told",
                                         GST_TYPE_STRUCTURE, readable));
}

static void
gst_visuotactile_sink_class_init(GstVisuotactileSinkClass *klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS(klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);

  object_class->set_property = gst_visuotactile_sink_set_property;
  object_class->get_property = gst_visuotactile_sink_get_property;
  object_class->dispose = gst_visuotactile_sink_dispose;
  object_class->finalize = gst_visuotactile_sink_finalize;
  install_properties(object_class);

  element_class->change_state = GST_DEBUG_FUNCPTR(gst_visuotactile_sink_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_set_static_metadata(element_class, "Visuotactile sink", "Sink/Video",
                                        "Shows a film and plays on motors what draws the eye in it",
                                        "The visuotactile authors");
}

/// Creates the parts; without any of them there are none, which is said when the play begins.
static void
gst_visuotactile_sink_build(GstVisuotactileSink *self)
{
  GstElement *analysis = gst_element_factory_make("saliencytactile", "analysis");
  GstElement *extractor = gst_element_factory_make("tactileextractor", "extractor");
  GstElement *queue = gst_element_factory_make("queue", "video-queue");
  GstTactileBranch *branch = gst_tactile_branch_new("tactile");
  if (!analysis || !extractor || !queue || !branch) {
    gst_clear_object(&analysis);
    gst_clear_object(&extractor);
    gst_clear_object(&queue);
    gst_clear_object(&branch);
    return;
  }
  g_object_set(analysis, "keep-maps", TRUE, nullptr);
  g_object_set(queue, "max-size-bytes", 0, "max-size-buffers", 0, nullptr);
  gst_bin_add_many(GST_BIN(self), analysis, extractor, queue, GST_ELEMENT(branch), nullptr);
  gst_element_link(analysis, extractor);
  gst_element_link_pads(extractor, "src", queue, "sink");
  gst_element_link_pads(extractor, "tactile", GST_ELEMENT(branch), "sink");
  self->analysis = analysis;
  self->queue = queue;
  self->branch = branch;
  gst_visuotactile_sink_add_placeholder(self);
}

static void
gst_visuotactile_sink_init(GstVisuotactileSink *self)
{
  self->settings = gst_structure_new_empty("settings");
  gst_visuotactile_sink_build(self);

  g_autoptr(GstPadTemplate) pad_template = gst_static_pad_template_get(&sink_template);
  self->sinkpad = gst_ghost_pad_new_no_target_from_template("sink", pad_template);
  if (self->analysis) {
    g_autoptr(GstPad) target = gst_element_get_static_pad(self->analysis, "sink");
    gst_ghost_pad_set_target(GST_GHOST_PAD(self->sinkpad), target);
  }
  gst_pad_set_query_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_visuotactile_sink_query));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);
  GST_OBJECT_FLAG_SET(self, GST_ELEMENT_FLAG_SINK);
}
