// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactilebranch.h"

#include "../tactile/wantedgrid.h"
#include "gst/video/writable_frame.h"
#include "soundjoin.h"
#include "twostreams.h"

#include <algorithm>
#include <atomic>
#include <vector>

namespace {

/// More than ten seconds of a film with one map on each frame. A track with a change each
/// millisecond fills it in one second; then the oldest maps are dropped.
constexpr guint kMostMaps = 1024;

/// A slow analysis falls behind by no more than this.
constexpr guint kMostFrames = 4;

using Elements = std::vector<GstElement *>;

} // namespace

struct _GstTactileBranch
{
  GstBin parent;
  GstElement *queue; ///< of the input, frames or maps
  Elements *rest;    ///< from there to tactorsink; own references: they may be out of the bin

  /* Object lock. */
  gboolean opening; ///< changing from READY to PAUSED
  gboolean failed;  ///< an error came since then
  gboolean ended;   ///< EOS was received
};

#define gst_tactile_branch_parent_class parent_class
G_DEFINE_TYPE(GstTactileBranch, gst_tactile_branch, GST_TYPE_BIN);

static gboolean
is_in(GstTactileBranch *self)
{
  g_autoptr(GstObject) parent = gst_object_get_parent(GST_OBJECT(self->rest->back()));
  return parent == GST_OBJECT(self);
}

/* The sink first, for which a queue's thread may wait. */
static void
stop(const Elements &elements)
{
  for (auto element = elements.rbegin(); element != elements.rend(); ++element)
    gst_element_set_state(*element, GST_STATE_NULL);
}

/* Removes all but the queue, so that the outer bin does not wait for its preroll and EOS. Not on a
 * streaming thread. */
static void
gst_tactile_branch_give_up(GstTactileBranch *self)
{
  if (!is_in(self))
    return;
  for (GstElement *element : *self->rest)
    gst_bin_remove(GST_BIN(self), element);
  stop(*self->rest);
  GST_OBJECT_LOCK(self);
  const gboolean ended = self->ended;
  GST_OBJECT_UNLOCK(self);
  if (ended)
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_eos(GST_OBJECT(self)));
}

static gboolean
has_failed(GstTactileBranch *self)
{
  GST_OBJECT_LOCK(self);
  const gboolean failed = self->failed;
  GST_OBJECT_UNLOCK(self);
  return failed;
}

/* Not if another play has begun, which has tactorsink back. */
static void
give_up_async(GstElement *element, gpointer)
{
  auto *self = GST_TACTILE_BRANCH(element);

  GST_STATE_LOCK(self);
  if (has_failed(self))
    gst_tactile_branch_give_up(self);
  GST_STATE_UNLOCK(self);
}

static void
gst_tactile_branch_restore(GstTactileBranch *self)
{
  if (is_in(self))
    return;
  GstElement *last = self->queue;
  for (GstElement *element : *self->rest) {
    gst_bin_add(GST_BIN(self), element);
    // tactileextractor's source pad of that name
    if (!gst_element_link_pads(last, "tactile", element, "sink"))
      gst_element_link(last, element);
    last = element;
  }
}

static void
gst_tactile_branch_handle_message(GstBin *bin, GstMessage *message)
{
  auto *self = GST_TACTILE_BRANCH(bin);

  /* Steps are reported by the video sink only: a player would take a second message for another
   * step. */
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_START
      || GST_MESSAGE_TYPE(message) == GST_MESSAGE_STEP_DONE) {
    gst_message_unref(message);
    return;
  }
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR) {
    GST_BIN_CLASS(parent_class)->handle_message(bin, message);
    return;
  }
  GST_OBJECT_LOCK(self);
  const gboolean opening = self->opening;
  const gboolean failed = self->failed;
  self->failed = TRUE;
  GST_OBJECT_UNLOCK(self);
  if (failed) { /* what follows from the first error */
    gst_message_unref(message);
    return;
  }
  g_autoptr(GError) error = nullptr;
  g_autofree gchar *debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  g_prefix_error(&error, "The film plays without touch: ");
  GstMessage *warning = gst_message_new_warning(GST_MESSAGE_SRC(message), error, debug);
  gst_message_unref(message);
  GST_BIN_CLASS(parent_class)->handle_message(bin, warning);
  if (!opening)
    gst_element_call_async(GST_ELEMENT(self), give_up_async, nullptr, nullptr);
}

static GstStateChangeReturn
gst_tactile_branch_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_TACTILE_BRANCH(element);
  const gboolean opening = transition == GST_STATE_CHANGE_READY_TO_PAUSED;

  if (opening)
    gst_tactile_branch_restore(self);
  GST_OBJECT_LOCK(self);
  self->opening = opening;
  if (opening)
    self->failed = self->ended = FALSE;
  GST_OBJECT_UNLOCK(self);

  GstStateChangeReturn ret = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (opening && ret == GST_STATE_CHANGE_FAILURE) {
    gst_tactile_branch_give_up(self);
    ret = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  }
  GST_OBJECT_LOCK(self);
  const gboolean failed = self->failed;
  self->opening = FALSE;
  GST_OBJECT_UNLOCK(self);
  /* The board, opened in the background, has failed already. */
  if (opening && failed && ret != GST_STATE_CHANGE_FAILURE && is_in(self))
    gst_element_call_async(element, give_up_async, nullptr, nullptr);
  return ret;
}

/* Steps by buffers are for the video sink; tactorsink steps by time. Seeks are the video sink's,
 * too: what one more sink sends comes upstream after the flush that it requests. */
static gboolean
gst_tactile_branch_send_event(GstElement *element, GstEvent *event)
{
  if (GST_EVENT_TYPE(event) == GST_EVENT_SEEK) {
    gst_event_unref(event);
    return TRUE;
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_STEP) {
    GstFormat format = GST_FORMAT_UNDEFINED;
    gst_event_parse_step(event, &format, nullptr, nullptr, nullptr, nullptr);
    if (format != GST_FORMAT_TIME) {
      gst_event_unref(event);
      return TRUE;
    }
  }
  return GST_ELEMENT_CLASS(parent_class)->send_event(element, event);
}

/* Upstream events (seek, latency, navigation) come from the video sink, too. A demuxer that gets a
 * seek twice flushes twice. The chair's grid is of this branch alone. */
static gboolean
gst_tactile_branch_upstream_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  if (is_grid_event(event))
    return gst_pad_event_default(pad, parent, event);
  gst_event_unref(event);
  return TRUE;
}

/* For upstream, maps that are not played are as good as played. */
static GstFlowReturn
gst_tactile_branch_chain(GstPad *pad, GstObject *parent, GstBuffer *buffer)
{
  if (has_failed(GST_TACTILE_BRANCH(parent))) {
    gst_buffer_unref(buffer);
    return GST_FLOW_OK;
  }
  const GstFlowReturn flow = gst_proxy_pad_chain_default(pad, parent, buffer);
  return flow < GST_FLOW_EOS || flow == GST_FLOW_NOT_LINKED ? GST_FLOW_OK : flow;
}

static gboolean
gst_tactile_branch_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  auto *self = GST_TACTILE_BRANCH(parent);
  const GstEventType type = GST_EVENT_TYPE(event);

  if (type == GST_EVENT_EOS || type == GST_EVENT_FLUSH_STOP || type == GST_EVENT_STREAM_START) {
    GST_OBJECT_LOCK(self);
    self->ended = type == GST_EVENT_EOS;
    GST_OBJECT_UNLOCK(self);
  }
  if ((gst_event_type_get_flags(type) & GST_EVENT_TYPE_SERIALIZED) && type != GST_EVENT_FLUSH_STOP
      && has_failed(self)) {
    gst_event_unref(event);
    return TRUE;
  }
  return gst_pad_event_default(pad, parent, event);
}

static void
gst_tactile_branch_dispose(GObject *object)
{
  auto *self = GST_TACTILE_BRANCH(object);
  if (!self->rest->empty() && !is_in(self)) // disposal may come twice
    stop(*self->rest);
  std::ranges::for_each(*self->rest, gst_object_unref);
  self->rest->clear();
  G_OBJECT_CLASS(parent_class)->dispose(object);
}

static void
gst_tactile_branch_finalize(GObject *object)
{
  delete GST_TACTILE_BRANCH(object)->rest;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_branch_class_init(GstTactileBranchClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);

  G_OBJECT_CLASS(klass)->dispose = gst_tactile_branch_dispose;
  G_OBJECT_CLASS(klass)->finalize = gst_tactile_branch_finalize;
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactile_branch_change_state);
  element_class->send_event = GST_DEBUG_FUNCPTR(gst_tactile_branch_send_event);
  GST_BIN_CLASS(klass)->handle_message = GST_DEBUG_FUNCPTR(gst_tactile_branch_handle_message);
  gst_element_class_set_static_metadata(element_class, "Tactile branch", "Sink",
                                        "Plays tactile maps if that is possible",
                                        "The visuotactile authors");
}

static void
gst_tactile_branch_init(GstTactileBranch *)
{
}

/* Never blocks the stream: what comes too fast leaves at the front. */
static GstElement *
make_queue(const gchar *name, guint most)
{
  GstElement *queue = gst_element_factory_make("queue", name);
  if (queue == nullptr)
    return nullptr;
  let_streams_follow(queue);
  gst_util_set_object_arg(G_OBJECT(queue), "leaky", "downstream");
  g_object_set(queue, "max-size-bytes", 0, "max-size-buffers", most, "max-size-time",
               G_GUINT64_CONSTANT(0), nullptr);
  return queue;
}

/* Takes the elements, of which the first one is a queue; NULL if one is missing. */
static GstTactileBranch *
gst_tactile_branch_new_of(const gchar *name, Elements elements)
{
  if (std::ranges::find(elements, nullptr) != elements.end()) {
    for (GstElement *element : elements)
      gst_clear_object(&element);
    return nullptr;
  }
  auto *self = GST_TACTILE_BRANCH(g_object_new(GST_TYPE_TACTILE_BRANCH, "name", name, nullptr));
  std::ranges::for_each(elements, gst_object_ref_sink);
  self->queue = elements.front();
  self->rest = new Elements(elements.begin() + 1, elements.end());
  gst_bin_add(GST_BIN(self), self->queue);
  gst_object_unref(self->queue); /* stays in the bin */
  gst_tactile_branch_restore(self);

  g_autoptr(GstPad) target = gst_element_get_static_pad(self->queue, "sink");
  GstPad *pad = gst_ghost_pad_new("sink", target);
  gst_pad_set_chain_function(pad, GST_DEBUG_FUNCPTR(gst_tactile_branch_chain));
  gst_pad_set_event_function(pad, GST_DEBUG_FUNCPTR(gst_tactile_branch_sink_event));
  g_autoptr(GstProxyPad) inside = gst_proxy_pad_get_internal(GST_PROXY_PAD(pad));
  gst_pad_set_event_function(GST_PAD(inside), GST_DEBUG_FUNCPTR(gst_tactile_branch_upstream_event));
  gst_element_add_pad(GST_ELEMENT(self), pad);
  return self;
}

GstTactileBranch *
gst_tactile_branch_new(const gchar *name)
{
  /* Frames are stepped in PAUSED, and tactorsink may preroll later or never. Maps are small. */
  return gst_tactile_branch_new_of(name, { make_queue("tactile-queue", kMostMaps),
                                           gst_sound_join_new("sound"),
                                           gst_element_factory_make("tactorsink", "tactors") });
}

/* The first frame of a stream, a segment or after a flush is discontinuous, also where the queue
 * dropped the one that was marked. All others are not: a frame that left the queue is no jump of
 * the film, and the analysis goes on after it. `begins`: a std::atomic<bool>. */
static GstPadProbeReturn
set_discont(GstPad *, GstPadProbeInfo *info, gpointer begins)
{
  auto &first = *static_cast<std::atomic<bool> *>(begins);
  if (!(info->type & GST_PAD_PROBE_TYPE_BUFFER)) {
    const GstEventType type = GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info));
    if (type == GST_EVENT_STREAM_START || type == GST_EVENT_SEGMENT || type == GST_EVENT_FLUSH_STOP)
      first = true;
    return GST_PAD_PROBE_OK;
  }
  GstBuffer *frame = GST_PAD_PROBE_INFO_BUFFER(info);
  const bool is_first = first.exchange(false);
  if (static_cast<bool>(GST_BUFFER_IS_DISCONT(frame)) == is_first)
    return GST_PAD_PROBE_OK;
  frame = writable_frame(frame);
  if (is_first)
    GST_BUFFER_FLAG_SET(frame, GST_BUFFER_FLAG_DISCONT);
  else
    GST_BUFFER_FLAG_UNSET(frame, GST_BUFFER_FLAG_DISCONT);
  info->data = frame;
  return GST_PAD_PROBE_OK;
}

GstTactileBranch *
gst_tactile_branch_new_with_analysis(const gchar *name)
{
  GstTactileBranch *self = gst_tactile_branch_new_of(
      name, { make_queue("frame-queue", kMostFrames),
              gst_element_factory_make("saliencytactile", "analysis"),
              gst_element_factory_make("tactileextractor", "extractor"),
              make_queue("tactile-queue", kMostMaps), gst_sound_join_new("sound"),
              gst_element_factory_make("tactorsink", "tactors") });
  if (self == nullptr)
    return nullptr;
  g_object_set(self->rest->front(), "keep-maps", TRUE, nullptr);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(self->queue, "src");
  gst_pad_add_probe(pad,
                    static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER
                                                 | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM
                                                 | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
                    set_discont, new std::atomic<bool>(true),
                    [](gpointer begins) { delete static_cast<std::atomic<bool> *>(begins); });
  return self;
}

GstElement *
gst_tactile_branch_get_tactors(GstTactileBranch *self)
{
  return self->rest->back();
}

GstElement *
gst_tactile_branch_get_analysis(GstTactileBranch *self)
{
  constexpr std::size_t kWithoutAnalysis = 2;
  return self->rest->size() > kWithoutAnalysis ? self->rest->front() : nullptr;
}

GstSoundJoin *
gst_tactile_branch_get_sound(GstTactileBranch *self)
{
  return GST_SOUND_JOIN((*self->rest)[self->rest->size() - 2]);
}

GstPad *
gst_tactile_branch_get_maps_pad(GstTactileBranch *self)
{
  return gst_element_get_static_pad(GST_ELEMENT(gst_tactile_branch_get_sound(self)), "src");
}
