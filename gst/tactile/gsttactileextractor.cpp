// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactileextractor
 * @title: tactileextractor
 * @short_description: takes the tactile maps off video frames as a stream of their own
 *
 * tactileextractor passes video through and sends the #GstTactileMeta of each frame as a buffer of
 * `application/x-tactile-map` on its `tactile` pad, with the frame's time stamp and duration. The
 * buffer holds no part of the frame: a queue in the tactile branch costs a few bytes per frame.
 *
 * A frame without a map is a GAP on the `tactile` pad. Before the first map the grid is what
 * downstream asks for, else 3 × 3. Either source pad may be left unlinked. As behind a demuxer,
 * each branch needs a queue of its own.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=90 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue ! videoconvert ! autovideosink \
 *     x.tactile ! queue ! fakesink sync=true dump=true
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! \
 *     videoconvert ! autovideosink \
 *     x.tactile ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! tactorsink
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactileextractor.h"

#include "gsttactileelements.h"
#include "wantedgrid.h"

#include <gst/base/gstflowcombiner.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

GST_DEBUG_CATEGORY_STATIC(tactile_extractor_debug);
#define GST_CAT_DEFAULT tactile_extractor_debug

struct _GstTactileExtractor
{
  GstElement parent;

  GstPad *sinkpad;
  GstPad *srcpad;
  GstPad *tactilepad;

  /* All below: streaming thread, or while it is stopped. */
  GstFlowCombiner *combiner;
  gint fps_n; /* of the video; 0: unknown or variable */
  gint fps_d;
  guint rows; /* of the tactile pad's caps; 0: none sent yet */
  guint columns;
  gboolean fps_changed;      /* since the tactile pad's caps were sent */
  GstEvent *pending_segment; /* for the tactile pad, which needs caps first */
};

#define gst_tactile_extractor_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileExtractor, gst_tactile_extractor, GST_TYPE_ELEMENT,
                        GST_DEBUG_CATEGORY_INIT(tactile_extractor_debug, "tactileextractor", 0,
                                                "tactile maps of a film as a stream"));
GST_ELEMENT_REGISTER_DEFINE(tactileextractor, "tactileextractor", GST_RANK_NONE,
                            GST_TYPE_TACTILE_EXTRACTOR);

#define VIDEO_CAPS "video/x-raw(ANY)"

static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
static GstStaticPadTemplate tactile_template = GST_STATIC_PAD_TEMPLATE(
    "tactile", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));

/* Sends caps with this grid, then a segment, on the tactile pad. */
static void
send_sticky_events(GstTactileExtractor *self, guint rows, guint columns)
{
  if (rows != self->rows || columns != self->columns || self->fps_changed) {
    GstCaps *caps = gst_tactile_map_caps_new(rows, columns, self->fps_n, self->fps_d);
    GST_DEBUG_OBJECT(self->tactilepad, "caps %" GST_PTR_FORMAT, caps);
    gst_pad_push_event(self->tactilepad, gst_event_new_caps(caps));
    gst_caps_unref(caps);
    self->rows = rows;
    self->columns = columns;
    self->fps_changed = FALSE;
  }
  if (self->pending_segment != nullptr) {
    gst_pad_push_event(self->tactilepad, self->pending_segment);
    self->pending_segment = nullptr;
  }
}

static void
send_default_sticky_events(GstTactileExtractor *self)
{
  guint rows = self->rows;
  guint columns = self->columns;
  if (rows == 0)
    wanted_grid(self->tactilepad, &rows, &columns);
  send_sticky_events(self, rows, columns);
}

/* Sends a serialized event, after caps and segment. */
static gboolean
push_tactile_event(GstTactileExtractor *self, GstEvent *event)
{
  send_default_sticky_events(self);
  return gst_pad_push_event(self->tactilepad, event);
}

static GstClockTime
frame_duration(GstTactileExtractor *self, GstBuffer *frame)
{
  if (GST_BUFFER_DURATION_IS_VALID(frame) || self->fps_n == 0)
    return GST_BUFFER_DURATION(frame);
  return gst_util_uint64_scale_int(GST_SECOND, self->fps_d, self->fps_n);
}

/* A branch that was unlinked during a push returns FLUSHING. That must not end the other branch. */
static GstFlowReturn
push(GstPad *pad, GstBuffer *buffer)
{
  const GstFlowReturn flow = gst_pad_push(pad, buffer);
  return flow == GST_FLOW_FLUSHING && !gst_pad_is_linked(pad) ? GST_FLOW_NOT_LINKED : flow;
}

static GstFlowReturn
push_tactile(GstTactileExtractor *self, GstBuffer *frame)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(frame);
  const GstClockTime pts = GST_BUFFER_PTS(frame);
  const GstClockTime duration = frame_duration(self, frame);

  if (meta == nullptr) {
    /* A GAP needs a time. An unlinked pad counts as with a buffer. */
    if (GST_CLOCK_TIME_IS_VALID(pts))
      push_tactile_event(self, gst_event_new_gap(pts, duration));
    return gst_pad_is_linked(self->tactilepad) ? GST_FLOW_OK : GST_FLOW_NOT_LINKED;
  }

  gsize n_levels = 0;
  const gfloat *levels = gst_tactile_meta_get_levels(meta, &n_levels);
  GstBuffer *map = gst_tactile_map_buffer_new(levels, n_levels);
  GST_BUFFER_PTS(map) = pts;
  GST_BUFFER_DURATION(map) = duration;
  if (GST_BUFFER_IS_DISCONT(frame))
    GST_BUFFER_FLAG_SET(map, GST_BUFFER_FLAG_DISCONT);
  send_sticky_events(self, meta->rows, meta->columns);
  return push(self->tactilepad, map);
}

static GstFlowReturn
gst_tactile_extractor_chain(GstPad *pad, GstObject *parent, GstBuffer *frame)
{
  (void)pad;
  auto *self = GST_TACTILE_EXTRACTOR(parent);

  /* The map first: tactors are needed earlier than the screen. */
  GstFlowReturn flow = push_tactile(self, frame);
  gst_flow_combiner_update_pad_flow(self->combiner, self->tactilepad, flow);
  flow = push(self->srcpad, frame);
  return gst_flow_combiner_update_pad_flow(self->combiner, self->srcpad, flow);
}

static void
send_stream_start(GstTactileExtractor *self, GstEvent *video)
{
  const gchar *video_id = nullptr;
  gst_event_parse_stream_start(video, &video_id);
  gchar *id = g_strconcat(video_id, "/tactile", nullptr);
  GstEvent *event = gst_event_new_stream_start(id);
  g_free(id);

  guint group = GST_GROUP_ID_INVALID;
  if (gst_event_parse_group_id(video, &group))
    gst_event_set_group_id(event, group);
  gst_event_set_seqnum(event, gst_event_get_seqnum(video));
  gst_pad_push_event(self->tactilepad, event);
}

static void
reset(GstTactileExtractor *self)
{
  gst_flow_combiner_reset(self->combiner);
  gst_clear_event(&self->pending_segment);
  self->rows = self->columns = 0;
  self->fps_n = 0;
  self->fps_d = 1;
  self->fps_changed = FALSE;
}

static void
read_framerate(GstTactileExtractor *self, GstEvent *event)
{
  GstCaps *caps = nullptr;
  gst_event_parse_caps(event, &caps);
  gint n = 0;
  gint d = 1;
  if (!gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &n, &d) || n < 0) {
    n = 0;
    d = 1;
  }
  self->fps_changed |= n != self->fps_n || d != self->fps_d;
  self->fps_n = n;
  self->fps_d = d;
}

/* Events that concern both streams go to both; those about pictures (caps, tags) go to the video
 * only. */
static gboolean
gst_tactile_extractor_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  (void)pad;
  auto *self = GST_TACTILE_EXTRACTOR(parent);
  gboolean handled = FALSE; /* by the tactile branch: then video may be unlinked */

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_STREAM_START:
    send_stream_start(self, event);
    break;
  case GST_EVENT_CAPS:
    read_framerate(self, event);
    break;
  case GST_EVENT_SEGMENT:
    if (self->rows > 0)
      gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    else
      gst_event_replace(&self->pending_segment, event);
    break;
  case GST_EVENT_GAP:
  case GST_EVENT_SEGMENT_DONE:
  case GST_EVENT_EOS:
    handled = push_tactile_event(self, gst_event_ref(event));
    break;
  case GST_EVENT_STREAM_GROUP_DONE:
  case GST_EVENT_INSTANT_RATE_CHANGE:
  case GST_EVENT_FLUSH_START:
    handled = gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    break;
  case GST_EVENT_FLUSH_STOP:
    gst_flow_combiner_reset(self->combiner);
    gst_clear_event(&self->pending_segment);
    handled = gst_pad_push_event(self->tactilepad, gst_event_ref(event));
    break;
  default:
    break;
  }
  return gst_pad_push_event(self->srcpad, event) || handled;
}

/* Video passes through: caps of both sides are the same. */
static gboolean
proxy_caps_query(GstPad *pad, GstPad *other, GstQuery *query)
{
  GstCaps *filter = nullptr;
  gst_query_parse_caps(query, &filter);
  GstCaps *own = gst_pad_get_pad_template_caps(pad);
  GstCaps *peer = gst_pad_peer_query_caps(other, filter);
  GstCaps *result = gst_caps_intersect_full(peer, own, GST_CAPS_INTERSECT_FIRST);
  gst_query_set_caps_result(query, result);
  gst_caps_unref(result);
  gst_caps_unref(peer);
  gst_caps_unref(own);
  return TRUE;
}

static gboolean
gst_tactile_extractor_sink_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_TACTILE_EXTRACTOR(parent);

  switch (GST_QUERY_TYPE(query)) {
  case GST_QUERY_CAPS:
    return proxy_caps_query(pad, self->srcpad, query);
  case GST_QUERY_ACCEPT_CAPS:
    if (!gst_pad_is_linked(self->srcpad))
      return gst_pad_query_default(pad, parent, query);
    return gst_pad_peer_query(self->srcpad, query);
  case GST_QUERY_ALLOCATION:
    return gst_pad_peer_query(self->srcpad, query);
  default:
    return gst_pad_query_default(pad, parent, query);
  }
}

static gboolean
gst_tactile_extractor_src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS)
    return proxy_caps_query(pad, GST_TACTILE_EXTRACTOR(parent)->sinkpad, query);
  return gst_pad_query_default(pad, parent, query);
}

static gboolean
gst_tactile_extractor_tactile_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_QOS:         /* late tactors are no reason to drop pictures */
  case GST_EVENT_RECONFIGURE: /* nor a new tactile branch one to negotiate them again */
    gst_event_unref(event);
    return TRUE;
  default:
    return gst_pad_event_default(pad, parent, event);
  }
}

static GstStateChangeReturn
gst_tactile_extractor_change_state(GstElement *element, GstStateChange transition)
{
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    reset(GST_TACTILE_EXTRACTOR(element));
  return result;
}

static void
gst_tactile_extractor_finalize(GObject *object)
{
  auto *self = GST_TACTILE_EXTRACTOR(object);
  gst_clear_event(&self->pending_segment);
  gst_flow_combiner_unref(self->combiner);
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_extractor_class_init(GstTactileExtractorClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);

  G_OBJECT_CLASS(klass)->finalize = gst_tactile_extractor_finalize;
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactile_extractor_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_add_static_pad_template(element_class, &tactile_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile map extractor", "Filter",
      "Passes video through and sends its tactile maps as a stream of their own",
      "The visuotactile authors");
}

static void
gst_tactile_extractor_init(GstTactileExtractor *self)
{
  self->sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_extractor_chain));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_extractor_sink_event));
  gst_pad_set_query_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_extractor_sink_query));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_tactile_extractor_src_query));
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);

  self->tactilepad = gst_pad_new_from_static_template(&tactile_template, "tactile");
  gst_pad_set_event_function(self->tactilepad,
                             GST_DEBUG_FUNCPTR(gst_tactile_extractor_tactile_event));
  gst_pad_use_fixed_caps(self->tactilepad);
  gst_element_add_pad(GST_ELEMENT(self), self->tactilepad);

  self->combiner = gst_flow_combiner_new();
  gst_flow_combiner_add_pad(self->combiner, self->srcpad);
  gst_flow_combiner_add_pad(self->combiner, self->tactilepad);
  self->fps_d = 1;
}
