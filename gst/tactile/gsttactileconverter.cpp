// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactileconverter
 * @title: tactileconverter
 * @short_description: converts tactile maps to text cues or KLV, and back
 *
 * tactileconverter converts a stream of tactile maps (`application/x-tactile-map`) to formats for
 * files, and back: text cues for Matroska, MP4 and subtitle files, KLV packets for MPEG transport
 * streams. The caps of downstream select the format. By default, maps become text, and text and
 * KLV become maps.
 *
 * A text cue is the grid, with one line of integer percentages for each row:
 *
 * |[
 *   0   0   0
 *   0  75  75
 *   0   0   0
 * ]|
 *
 * A cue begins when the map changes, and at least every second. It is complete at the next map.
 * Therefore the latency towards text and KLV is 1 s: queue parallel branches for as long. Text has
 * times in milliseconds and levels in percent; KLV is exact. Time without a cue becomes a GAP. The
 * element drops anything that is not a cue, such as subtitles, with a warning.
 *
 * Other players show a text track in Matroska or MP4, because GStreamer's muxers mark it as the
 * default; `tactile-track mux` does not. See [tracks](../guide/tracks.md).
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=300 ! saliencytactile ! tactileextractor name=x \
 *     x.tactile ! tactileconverter ! webvttenc ! filesink location=track.vtt
 * gst-launch-1.0 tactiletestsrc num-buffers=300 ! saliencytactile ! tactileextractor name=x \
 *     x.tactile ! tactileconverter ! meta/x-klv ! tactileconverter ! tactorsink driver=simulator
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactileconverter.h"

#include "../latency.h"
#include "gst/cues/cue_stream.h"
#include "gsttactileelements.h"
#include "tracks/cue_builder.h"
#include "tracks/track.h"
#include "wantedgrid.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

using tactile::Cue;
using tactile::Time;

GST_DEBUG_CATEGORY_STATIC(tactile_converter_debug);
#define GST_CAT_DEFAULT tactile_converter_debug

namespace {

/// Output forms for an input form, preferred first.
constexpr std::array<CueForm, 3>
preferred(CueForm in)
{
  return in == CueForm::map
             ? std::array{ CueForm::text, CueForm::klv, CueForm::map }
             : std::array{ CueForm::map, in, in == CueForm::text ? CueForm::klv : CueForm::text };
}

/// Rounds levels to whole percents, as in a text cue.
void
round_levels(tactile::TactileMap &map)
{
  for (float &level : map.levels)
    level = std::round(level * 100.0F) / 100.0F;
}

Time
to_time(GstClockTime time)
{
  return Time(static_cast<Time::rep>(std::min<GstClockTime>(
      time, static_cast<GstClockTime>(2 * tactile::Track::kMaxEnd.count()))));
}

} // namespace

/// Streaming thread, or while it is stopped.
struct GstTactileConverterPrivate
{
  std::optional<CueForm> in;
  std::optional<CueForm> out;
  guint rows = 0; ///< of input maps
  guint columns = 0;
  gint fps_n = 0;
  gint fps_d = 1;
  std::optional<tactile::Grid> grid; ///< of the last cue
  tactile::CueBuilder builder;
  GstEvent *pending_segment = nullptr; ///< until the source pad has caps
  bool has_caps = false;               ///< of the source pad
  guint sent_rows = 0;                 ///< of the source pad's caps
  guint sent_columns = 0;
  Time last_end{ 0 }; ///< of the output
  bool warned = false;
  bool interrupted = true; ///< the next cue does not follow the last one

  ~GstTactileConverterPrivate()
  {
    gst_clear_event(&pending_segment);
  }
};

struct _GstTactileConverter
{
  GstElement parent;

  GstPad *sinkpad;
  GstPad *srcpad;
  gint waits; /* for the next map until a cue is complete; atomic */
  GstTactileConverterPrivate *priv;
};

#define gst_tactile_converter_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileConverter, gst_tactile_converter, GST_TYPE_ELEMENT,
                        GST_DEBUG_CATEGORY_INIT(tactile_converter_debug, "tactileconverter", 0,
                                                "tactile maps as text and KLV"));
GST_ELEMENT_REGISTER_DEFINE(tactileconverter, "tactileconverter", GST_RANK_NONE,
                            GST_TYPE_TACTILE_CONVERTER);

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS,
    GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS
                    "; text/x-raw, format = (string) { utf8, pango-markup }; " CUE_KLV_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS "; " CUE_TEXT_CAPS "; " CUE_KLV_CAPS));

/* ---- output ---- */

/* Sends caps, then the pending segment, on the source pad. */
static void
send_sticky_events(GstTactileConverter *self, guint rows, guint columns)
{
  GstTactileConverterPrivate *priv = self->priv;
  const bool is_map = priv->out == CueForm::map;
  if (!priv->has_caps || (is_map && (rows != priv->sent_rows || columns != priv->sent_columns))) {
    GstCaps *caps = is_map ? gst_tactile_map_caps_new(rows, columns,
                                                      priv->in == CueForm::map ? priv->fps_n : 0,
                                                      priv->in == CueForm::map ? priv->fps_d : 1)
                           : cue_caps_new(*priv->out);
    GST_DEBUG_OBJECT(self, "caps %" GST_PTR_FORMAT, caps);
    gst_pad_push_event(self->srcpad, gst_event_new_caps(caps));
    gst_caps_unref(caps);
    priv->has_caps = true;
    priv->sent_rows = rows;
    priv->sent_columns = columns;
  }
  if (priv->pending_segment != nullptr)
    gst_pad_push_event(self->srcpad, std::exchange(priv->pending_segment, nullptr));
}

static void
send_default_sticky_events(GstTactileConverter *self)
{
  GstTactileConverterPrivate *priv = self->priv;
  guint rows = priv->sent_rows;
  guint columns = priv->sent_columns;
  if (!priv->out)
    priv->out = CueForm::map; /* nothing ever came */
  if (priv->out == CueForm::map && !priv->has_caps) {
    rows = priv->rows;
    columns = priv->columns;
    if (rows == 0)
      wanted_grid(self->srcpad, &rows, &columns);
  }
  send_sticky_events(self, rows, columns);
}

/* A GAP up to `end`, if any time is left. */
static void
push_gap(GstTactileConverter *self, Time end)
{
  GstTactileConverterPrivate *priv = self->priv;
  if (end - priv->last_end <= tactile::CueBuilder::kSeam)
    return;
  send_default_sticky_events(self);
  gst_pad_push_event(self->srcpad,
                     gst_event_new_gap(static_cast<GstClockTime>(priv->last_end.count()),
                                       static_cast<GstClockTime>((end - priv->last_end).count())));
  priv->last_end = end;
}

static GstFlowReturn
push_cue(GstTactileConverter *self, const Cue &cue)
{
  GstTactileConverterPrivate *priv = self->priv;
  send_sticky_events(self, static_cast<guint>(cue.map.rows), static_cast<guint>(cue.map.columns));
  push_gap(self, cue.begin);

  priv->last_end = std::max(priv->last_end, cue.end);
  GstBuffer *buffer = cue_buffer_new(cue, *priv->out);
  if (std::exchange(priv->interrupted, false))
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
  return gst_pad_push(self->srcpad, buffer);
}

static GstFlowReturn
push_complete_cues(GstTactileConverter *self)
{
  GstFlowReturn flow = GST_FLOW_OK;
  while (flow == GST_FLOW_OK) {
    const std::optional<Cue> cue = self->priv->builder.take();
    if (!cue)
      break;
    flow = push_cue(self, *cue);
  }
  return flow;
}

static GstFlowReturn
drain(GstTactileConverter *self)
{
  self->priv->builder.flush();
  return push_complete_cues(self);
}

/* ---- input ---- */

static GstClockTime
duration_of(GstTactileConverter *self, GstBuffer *buffer, const Cue &cue)
{
  GstTactileConverterPrivate *priv = self->priv;
  if (GST_BUFFER_DURATION_IS_VALID(buffer) && GST_BUFFER_DURATION(buffer) > 0)
    return GST_BUFFER_DURATION(buffer);
  if (cue.end > Time(0))
    return static_cast<GstClockTime>(cue.end.count());
  if (priv->fps_n > 0)
    return gst_util_uint64_scale_int(GST_SECOND, priv->fps_d, priv->fps_n);
  return static_cast<GstClockTime>(tactile::CueBuilder::kLongest.count());
}

static GstFlowReturn
convert(GstTactileConverter *self, GstBuffer *buffer, CueForm form)
{
  GstTactileConverterPrivate *priv = self->priv;
  const tactile::Grid caps_grid{ static_cast<int>(priv->rows), static_cast<int>(priv->columns) };
  tl::expected<Cue, tactile::FormatError> read
      = cue_from_buffer(buffer, form, form == CueForm::map ? caps_grid : priv->grid);
  if (!read && priv->grid && cue_is_remark(buffer, form))
    return GST_FLOW_OK;
  if (!read) {
    const std::string why = read.error().text();
    GST_WARNING_OBJECT(self, "buffer at %" GST_TIME_FORMAT " is no map: %s",
                       GST_TIME_ARGS(GST_BUFFER_PTS(buffer)), why.c_str());
    if (!std::exchange(priv->warned, true))
      GST_ELEMENT_WARNING(
          self, STREAM, DECODE,
          ("A cue is no tactile map and is left out; is this another kind of "
           "subtitles?"),
          ("at %" GST_TIME_FORMAT ": %s", GST_TIME_ARGS(GST_BUFFER_PTS(buffer)), why.c_str()));
    return GST_FLOW_OK;
  }
  Cue &cue = *read;
  priv->grid = { cue.map.rows, cue.map.columns };
  const Time duration = to_time(duration_of(self, buffer, cue));
  cue.begin = GST_BUFFER_PTS_IS_VALID(buffer) ? to_time(GST_BUFFER_PTS(buffer)) : priv->last_end;
  cue.end = cue.begin + duration;
  if (priv->out == CueForm::map)
    return push_cue(self, cue);
  if (priv->out == CueForm::text) {
    constexpr Time kTick = std::chrono::milliseconds(1);
    round_levels(cue.map);
    cue.begin = cue.begin / kTick * kTick;
    cue.end = cue.end / kTick * kTick;
  }
  priv->builder.add(cue.begin, cue.end, cue.map);
  return push_complete_cues(self);
}

static GstFlowReturn
gst_tactile_converter_chain(GstPad *pad, GstObject *parent, GstBuffer *buffer)
{
  (void)pad;
  auto *self = GST_TACTILE_CONVERTER(parent);
  GstTactileConverterPrivate *priv = self->priv;
  if (!priv->in) {
    gst_buffer_unref(buffer);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  if (priv->in == priv->out) { /* as it is */
    send_default_sticky_events(self);
    return gst_pad_push(self->srcpad, buffer);
  }
  const GstFlowReturn flow = convert(self, buffer, *priv->in);
  gst_buffer_unref(buffer);
  return flow;
}

/* Takes new input caps and negotiates the output form. */
static gboolean
set_caps(GstTactileConverter *self, GstCaps *caps)
{
  GstTactileConverterPrivate *priv = self->priv;
  drain(self);
  priv->in = cue_form_of(caps);
  priv->rows = priv->columns = 0;
  priv->fps_n = 0;
  priv->fps_d = 1;
  if (priv->in == CueForm::map
      && !gst_tactile_map_caps_parse(caps, &priv->rows, &priv->columns, &priv->fps_n, &priv->fps_d))
    return FALSE;

  GstCaps *own = gst_pad_get_pad_template_caps(self->srcpad);
  GstCaps *allowed = gst_pad_peer_query_caps(self->srcpad, own);
  gst_caps_unref(own);
  std::optional<CueForm> out;
  for (const CueForm form : preferred(*priv->in)) {
    GstCaps *of_form = cue_caps_new(form);
    if (!out && gst_caps_can_intersect(allowed, of_form))
      out = form;
    gst_caps_unref(of_form);
  }
  gst_caps_unref(allowed);
  if (!out) {
    GST_ERROR_OBJECT(self, "downstream takes neither maps nor text nor KLV");
    return FALSE;
  }
  priv->has_caps = priv->has_caps && out == priv->out && out != CueForm::map;
  priv->out = out;
  g_atomic_int_set(&self->waits, priv->in == CueForm::map && out != CueForm::map);
  gst_element_post_message(GST_ELEMENT(self), gst_message_new_latency(GST_OBJECT(self)));
  return TRUE;
}

static void
reset(GstTactileConverter *self)
{
  delete self->priv;
  self->priv = new GstTactileConverterPrivate;
}

static void
take_segment(GstTactileConverter *self, GstEvent *event)
{
  const GstSegment *segment = nullptr;
  gst_event_parse_segment(event, &segment);
  drain(self);
  self->priv->interrupted = true;
  self->priv->last_end = segment->format == GST_FORMAT_TIME ? to_time(segment->start) : Time(0);
  gst_event_replace(&self->priv->pending_segment, event);
}

static gboolean
gst_tactile_converter_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  auto *self = GST_TACTILE_CONVERTER(parent);
  GstTactileConverterPrivate *priv = self->priv;

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_CAPS: {
    GstCaps *caps = nullptr;
    gst_event_parse_caps(event, &caps);
    const gboolean is_set = set_caps(self, caps);
    gst_event_unref(event);
    return is_set;
  }
  case GST_EVENT_SEGMENT:
    take_segment(self, event);
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_GAP: {
    GstClockTime begin = 0;
    GstClockTime duration = 0;
    gst_event_parse_gap(event, &begin, &duration);
    g_autoptr(GstBuffer) packet = priv->in ? cue_gap_get_packet(event) : nullptr;
    if (packet) {
      convert(self, packet, CueForm::klv);
    } else if (priv->in && priv->in == priv->out) { /* as it is */
      send_default_sticky_events(self);
      return gst_pad_push_event(self->srcpad, event);
    } else {
      drain(self);
      if (GST_CLOCK_TIME_IS_VALID(duration))
        begin += duration;
      push_gap(self, to_time(begin));
    }
    gst_event_unref(event);
    return TRUE;
  }
  case GST_EVENT_EOS:
  case GST_EVENT_SEGMENT_DONE:
    drain(self);
    send_default_sticky_events(self);
    break;
  case GST_EVENT_FLUSH_STOP:
    priv->builder.reset();
    priv->interrupted = true;
    gst_clear_event(&priv->pending_segment);
    break;
  default:
    break;
  }
  return gst_pad_event_default(pad, parent, event);
}

static gboolean
gst_tactile_converter_src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_TACTILE_CONVERTER(parent);
  if (!gst_pad_query_default(pad, parent, query))
    return FALSE;
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY && g_atomic_int_get(&self->waits))
    latency::add(query, static_cast<GstClockTime>(tactile::CueBuilder::kLongest.count()));
  return TRUE;
}

static GstStateChangeReturn
gst_tactile_converter_change_state(GstElement *element, GstStateChange transition)
{
  const GstStateChangeReturn result
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    reset(GST_TACTILE_CONVERTER(element));
  return result;
}

static void
gst_tactile_converter_finalize(GObject *object)
{
  delete GST_TACTILE_CONVERTER(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_converter_class_init(GstTactileConverterClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);

  G_OBJECT_CLASS(klass)->finalize = gst_tactile_converter_finalize;
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactile_converter_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile map converter", "Converter/Tactile",
      "Turns tactile maps into text cues or KLV, and those into maps", "The visuotactile authors");
}

static void
gst_tactile_converter_init(GstTactileConverter *self)
{
  self->priv = new GstTactileConverterPrivate;
  self->sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_converter_chain));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_converter_sink_event));
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_tactile_converter_src_query));
  gst_pad_use_fixed_caps(self->srcpad);
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);
}
