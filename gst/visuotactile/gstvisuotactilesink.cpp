// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-visuotactilesink
 * @title: visuotactilesink
 * @short_description: a video sink that also plays a chair, for any player
 *
 * visuotactilesink shows a film and plays it on the motors of a chair.
 * [Applications](../guide/integration.md) explains its use in players. It is a bin with
 * `saliencytactile` (child `analysis`), `tactorsink` (child `tactors`) and the video sink.
 *
 * - The [settings of the user](../guide/players.md) set the properties that have their default. If
 *   they disable the chair, the element only shows the film.
 * - Picture and sound are delayed by `max-lead` and 10 ms.
 * - If the tactors fail, the film plays on, with a warning; the next start tries again. If no
 *   video sink works, the film is felt, but not shown.
 * - Frames that already have a map keep it. Frames in a GPU's memory stay there: see
 *   [saliencytactile](saliencytactile.md). Unreadable frames are shown and not felt.
 * - The analysis has its own thread.
 * - Impacts in the sound are felt if a [soundtactile](soundtactile.md) is in the same pipeline;
 *   the property `sound` selects the mix. Maps then wait for 95 ms, in whole frames, which is
 *   additional latency of a live source.
 * - `GstVideoOverlay` and `GstNavigation` are those of the video sink.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! videoconvert ! \
 *     visuotactilesink driver=simulator trace-location=commands.csv analysis::profile=paper
 * gst-launch-1.0 playbin uri=file://FILM video-sink="visuotactilesink rows=2 columns=4"
 * gst-launch-1.0 playbin uri=file://FILM audio-filter=soundtactile video-sink=visuotactilesink
 * ]|
 *
 * Since: 0.1
 */
#include "gstvisuotactilesink.h"

#include "../pooldemand.h"
#include "chairproperties.h"
#include "sinkparts.h"
#include "sinkproperties.h"
#include "sinkwindow.h"
#include "twostreams.h"
#include "videosinks.h"

#include <gst/video/navigation.h>
#include <gst/video/video.h>
#include <gst/video/videooverlay.h>

#include <utility>

GST_DEBUG_CATEGORY_STATIC(visuotactile_sink_debug);
#define GST_CAT_DEFAULT visuotactile_sink_debug

namespace {

/// Time for planning and wake-up, before max-lead; as in tactorsink.
constexpr GstClockTime kWakeMargin = 10 * GST_MSECOND;

/// Time in the video queue beyond the lead.
constexpr GstClockTime kLookahead = 200 * GST_MSECOND;

/// Frames that wait for the analysis. It has a thread of its own, as reading a GPU's memory takes
/// a while.
constexpr guint kMostWaiting = 2;

} // namespace

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

// System memory is listed too: playbin counts the caps features in common with a decoder, and does
// not know ANY.
static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw; video/x-raw(ANY)"));

/// How much earlier than the picture tactorsink needs its maps.
static GstClockTime
gst_visuotactile_sink_lead(GstVisuotactileSink *self)
{
  guint64 max_lead = 0;
  if (gst_element_is_locked_state(self->analysis))
    return 0; // switched off
  g_object_get(gst_visuotactile_sink_get_tactors(self), "max-lead", &max_lead, nullptr);
  return max_lead + kWakeMargin;
}

/* ---- the chair ---- */

/// Whether frames go through the analysis, or straight to the picture.
static void
gst_visuotactile_sink_feel(GstVisuotactileSink *self, bool felt)
{
  for (GstElement *part :
       { self->frames, self->analysis, self->extractor, GST_ELEMENT(self->branch) })
    gst_element_set_locked_state(part, !felt);
  g_autoptr(GstPad) first = gst_element_get_static_pad(felt ? self->frames : self->queue, "sink");
  gst_ghost_pad_set_target(GST_GHOST_PAD(self->sinkpad), nullptr);
  if (felt) {
    GST_OBJECT_FLAG_SET(self->branch, GST_ELEMENT_FLAG_SINK);
    gst_element_link_pads(self->extractor, "src", self->queue, "sink");
  } else {
    GST_OBJECT_FLAG_UNSET(self->branch, GST_ELEMENT_FLAG_SINK); // or its EOS would be awaited
    gst_element_unlink(self->extractor, self->queue);
  }
  gst_ghost_pad_set_target(GST_GHOST_PAD(self->sinkpad), first);
}

/// NULL to READY: applies the user's settings.
static void
gst_visuotactile_sink_apply_settings(GstVisuotactileSink *self)
{
  const bool felt = self->properties->open().enabled(true);
  if (felt)
    self->properties->post_driver();
  if (felt == gst_element_is_locked_state(self->analysis))
    gst_visuotactile_sink_feel(self, felt);
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
                        ("No video sink can be used: the film is felt, but not shown."),
                        ("%s", errors->len > 0 ? errors->str : "no video sink has a rank"));
    chosen = gst_element_factory_make("fakesink", "video-sink");
    g_object_set(chosen, "sync", TRUE, nullptr);
  }
  // The grid follows the orientation tag; sinks do so only if they are set to.
  g_auto(GValue) direction = G_VALUE_INIT;
  g_value_init(&direction, GST_TYPE_VIDEO_ORIENTATION_METHOD);
  g_value_set_enum(&direction, GST_VIDEO_ORIENTATION_AUTO);
  set_property_within(chosen, "video-direction", &direction);
  return chosen;
}

/// Links a placeholder while there is no video sink. Otherwise gst_parse_bin_from_description()
/// would take the unlinked pad for one of the outer bin.
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

/// NULL to READY: uses video-sink, or chooses one.
static gboolean
gst_visuotactile_sink_open(GstVisuotactileSink *self)
{
  if (self->branch == nullptr) {
    GST_ELEMENT_ERROR(self, CORE, MISSING_PLUGIN,
                      ("visuotactilesink needs saliencytactile, tactileextractor and tactorsink."),
                      ("expected the plugins saliency, tactile and tactor beside this one"));
    return FALSE;
  }
  gst_visuotactile_sink_apply_settings(self);
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
      || (transition == GST_STATE_CHANGE_NULL_TO_READY && ret == GST_STATE_CHANGE_FAILURE)) {
    gst_visuotactile_sink_remove_shown(self);
    if (self->properties)
      self->properties->close();
  }
  return ret;
}

/* ---- stream ---- */

static gboolean
gst_visuotactile_sink_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  const gboolean answered = gst_pad_query_default(pad, parent, query);
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION)
    return answered;
  // Also if the video sink does not answer.
  demand_buffers(query, gst_visuotactile_sink_lead(GST_VISUOTACTILE_SINK(parent)),
                 kMostWaiting + 1);
  return TRUE;
}

/// The picture was stepped by frames: steps the tactors by the same time, as playsink does with the
/// sound.
static void
gst_visuotactile_sink_follow_step(GstVisuotactileSink *self, GstMessage *message)
{
  GstFormat format = GST_FORMAT_UNDEFINED;
  gdouble rate = 1;
  gboolean flush = FALSE;
  gboolean intermediate = FALSE;
  guint64 duration = 0;

  gst_message_parse_step_done(message, &format, nullptr, &rate, &flush, &intermediate, &duration,
                              nullptr);
  if (format != GST_FORMAT_BUFFERS || self->branch == nullptr)
    return; // a step by time went to all sinks
  GstEvent *step = gst_event_new_step(GST_FORMAT_TIME, duration, rate, flush, intermediate);
  gst_event_set_seqnum(step, gst_message_get_seqnum(message));
  gst_element_send_event(GST_ELEMENT(self->branch), step);
}

static void
gst_visuotactile_sink_handle_message(GstBin *bin, GstMessage *message)
{
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_DONE)
    gst_visuotactile_sink_follow_step(GST_VISUOTACTILE_SINK(bin), message);
  GST_BIN_CLASS(parent_class)->handle_message(bin, message);
}

/* ---- children ---- */

/// Finds children by name, tactorsink also while it is out of its branch.
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
  // Children by index are the bin's.
  static_cast<GstChildProxyInterface *>(iface)->get_child_by_name
      = gst_visuotactile_sink_get_child_by_name;
}

static void
gst_visuotactile_sink_dispose(GObject *object)
{
  auto *self = GST_VISUOTACTILE_SINK(object);
  gst_visuotactile_sink_remove_shown(self);
  gst_clear_object(&self->wanted);
  delete std::exchange(self->properties, nullptr);
  G_OBJECT_CLASS(parent_class)->dispose(object);
}

static void
gst_visuotactile_sink_finalize(GObject *object)
{
  gst_structure_free(GST_VISUOTACTILE_SINK(object)->settings);
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_visuotactile_sink_class_init(GstVisuotactileSinkClass *klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS(klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);

  object_class->dispose = gst_visuotactile_sink_dispose;
  object_class->finalize = gst_visuotactile_sink_finalize;
  gst_visuotactile_sink_install_properties(object_class);

  element_class->change_state = GST_DEBUG_FUNCPTR(gst_visuotactile_sink_change_state);
  GST_BIN_CLASS(klass)->handle_message = GST_DEBUG_FUNCPTR(gst_visuotactile_sink_handle_message);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_set_static_metadata(
      element_class, "Visuotactile sink", "Sink/Video",
      "Shows a film and plays the events that draw the eye on motors", "The visuotactile authors");
}

/// Creates the children. If one is missing there are none, and opening fails.
static void
gst_visuotactile_sink_build(GstVisuotactileSink *self)
{
  GstElement *frames = gst_element_factory_make("queue", "frame-queue");
  GstElement *analysis = gst_element_factory_make("saliencytactile", "analysis");
  GstElement *extractor = gst_element_factory_make("tactileextractor", "extractor");
  GstElement *queue = gst_element_factory_make("queue", "video-queue");
  GstTactileBranch *branch = gst_tactile_branch_new("tactile");
  if (!frames || !analysis || !extractor || !queue || !branch) {
    gst_clear_object(&frames);
    gst_clear_object(&analysis);
    gst_clear_object(&extractor);
    gst_clear_object(&queue);
    gst_clear_object(&branch);
    return;
  }
  let_streams_follow(frames);
  let_streams_follow(queue);
  g_object_set(analysis, "keep-maps", TRUE, nullptr);
  g_object_set(frames, "max-size-bytes", 0, "max-size-buffers", kMostWaiting, "max-size-time",
               G_GUINT64_CONSTANT(0), nullptr);
  g_object_set(queue, "max-size-bytes", 0, "max-size-buffers", 0, nullptr);
  gst_bin_add_many(GST_BIN(self), frames, analysis, extractor, queue, GST_ELEMENT(branch), nullptr);
  gst_element_link_many(frames, analysis, extractor, nullptr);
  gst_element_link_pads(extractor, "src", queue, "sink");
  gst_element_link_pads(extractor, "tactile", GST_ELEMENT(branch), "sink");
  self->frames = frames;
  self->analysis = analysis;
  self->extractor = extractor;
  self->queue = queue;
  self->branch = branch;
  self->properties = new ChairProperties(GST_ELEMENT(self),
                                         { analysis, gst_tactile_branch_get_tactors(branch),
                                           GST_ELEMENT(gst_tactile_branch_get_sound(branch)) });
  gst_visuotactile_sink_add_placeholder(self);
}

static void
gst_visuotactile_sink_init(GstVisuotactileSink *self)
{
  self->settings = gst_structure_new_empty("settings");
  gst_visuotactile_sink_build(self);

  g_autoptr(GstPadTemplate) pad_template = gst_static_pad_template_get(&sink_template);
  self->sinkpad = gst_ghost_pad_new_no_target_from_template("sink", pad_template);
  if (self->frames) {
    g_autoptr(GstPad) target = gst_element_get_static_pad(self->frames, "sink");
    gst_ghost_pad_set_target(GST_GHOST_PAD(self->sinkpad), target);
  }
  gst_pad_set_query_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_visuotactile_sink_query));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);
  GST_OBJECT_FLAG_SET(self, GST_ELEMENT_FLAG_SINK);
}
