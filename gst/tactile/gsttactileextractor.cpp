// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactileextractor
 * @title: tactileextractor
 * @short_description: sends the tactile maps of video frames as a separate stream
 *
 * tactileextractor passes video through and sends the #GstTactileMeta of each frame as a buffer of
 * `application/x-tactile-map` on its `tactile` pad, with the time stamp and duration of the frame.
 * Maps of a track that begin within the frame follow at their own times. The buffer does not
 * reference the frame: a queue in the tactile branch needs a few bytes for each frame.
 *
 * A frame without a map is a GAP on the `tactile` pad. The first one is reported by an INFO
 * message, as elements that move the picture, such as `videoflip`, drop the map. Before the first
 * map, the grid is the one that downstream prefers, or 3 × 3. Either source pad may be
 * unlinked. Each branch needs its own queue, as after a demuxer.
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

#include "gst/fusion/later_maps.h"
#include "gst/fusion/sound_meta.h"
#include "gsttactileelements.h"
#include "splitpads.h"

#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <utility>

GST_DEBUG_CATEGORY_STATIC(tactile_extractor_debug);
#define GST_CAT_DEFAULT tactile_extractor_debug

struct _GstTactileExtractor
{
  GstElement parent;

  SplitPads *pads;
  GstClockTime frame_duration; /* by the framerate, as pads */
  gboolean posted_no_map;      /* as pads */
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

static GstFlowReturn
push_tactile(GstTactileExtractor *self, GstBuffer *frame)
{
  if (GST_BUFFER_IS_DISCONT(frame))
    self->pads->interrupt();
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(frame);
  const GstClockTime pts = GST_BUFFER_PTS(frame);
  const GstClockTime duration
      = GST_BUFFER_DURATION_IS_VALID(frame) ? GST_BUFFER_DURATION(frame) : self->frame_duration;

  if (meta == nullptr && !std::exchange(self->posted_no_map, TRUE))
    GST_ELEMENT_INFO(self, STREAM, FORMAT, ("The video frames carry no tactile map."),
                     ("expected a GstTactileMeta on each frame; put saliencytactile before "
                      "tactileextractor, and behind what moves the picture and drops the map, such "
                      "as videoflip and videocrop"));
  if (meta == nullptr) /* a GAP needs a time */
    return GST_CLOCK_TIME_IS_VALID(pts) ? self->pads->push_gap(pts, duration)
                                        : self->pads->maps_flow();

  const GstClockTime end = GST_CLOCK_TIME_IS_VALID(duration) ? pts + duration : pts;
  GstBufferList *later = GST_CLOCK_TIME_IS_VALID(pts) ? later_maps(frame) : nullptr;
  guint n_later = later ? gst_buffer_list_length(later) : 0;
  const auto begin_of = [&](guint i) {
    return i < n_later ? pts + GST_BUFFER_PTS(gst_buffer_list_get(later, i)) : end;
  };
  while (n_later > 0 && begin_of(n_later - 1) >= end) /* of a frame that was cut, as by videorate */
    n_later--;

  gsize n_levels = 0;
  const gfloat *levels = gst_tactile_meta_get_levels(meta, &n_levels);
  GstBuffer *map = gst_tactile_map_buffer_new(levels, n_levels);
  gst_buffer_set_tactile_frequency(map, gst_buffer_get_tactile_frequency(frame));
  GST_BUFFER_PTS(map) = pts;
  GST_BUFFER_DURATION(map) = n_later > 0 ? begin_of(0) - pts : duration;
  if (has_sound_meta(frame))
    GST_BUFFER_FLAG_SET(map, kSoundMap);
  self->pads->announce(meta->rows, meta->columns);
  GstFlowReturn flow = self->pads->push_map(map);
  for (guint i = 0; i < n_later && flow == GST_FLOW_OK; i++) {
    map = gst_buffer_copy(gst_buffer_list_get(later, i));
    GST_BUFFER_PTS(map) = begin_of(i);
    GST_BUFFER_DURATION(map) = begin_of(i + 1) - begin_of(i);
    flow = self->pads->push_map(map);
  }
  return flow;
}

static GstFlowReturn
gst_tactile_extractor_chain(GstPad *, GstObject *parent, GstBuffer *frame)
{
  auto *self = GST_TACTILE_EXTRACTOR(parent);

  /* The map first: tactors are needed earlier than the screen. */
  const GstFlowReturn flow = push_tactile(self, frame);
  return self->pads->pass(frame, flow);
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
  self->pads->set_framerate(n, d);
  self->frame_duration = n > 0 ? gst_util_uint64_scale_int(GST_SECOND, d, n) : GST_CLOCK_TIME_NONE;
}

static gboolean
gst_tactile_extractor_sink_event(GstPad *, GstObject *parent, GstEvent *event)
{
  auto *self = GST_TACTILE_EXTRACTOR(parent);

  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS)
    read_framerate(self, event);
  return self->pads->pass_event(event);
}

static GstStateChangeReturn
gst_tactile_extractor_change_state(GstElement *element, GstStateChange transition)
{
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
    auto *self = GST_TACTILE_EXTRACTOR(element);
    self->pads->reset();
    self->frame_duration = GST_CLOCK_TIME_NONE;
    self->posted_no_map = FALSE;
  }
  return result;
}

static void
gst_tactile_extractor_finalize(GObject *object)
{
  delete GST_TACTILE_EXTRACTOR(object)->pads;
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
  self->pads = new SplitPads(GST_ELEMENT(self),
                             { .chain = GST_DEBUG_FUNCPTR(gst_tactile_extractor_chain),
                               .event = GST_DEBUG_FUNCPTR(gst_tactile_extractor_sink_event),
                               .maps_come = true });
  self->frame_duration = GST_CLOCK_TIME_NONE;
}
