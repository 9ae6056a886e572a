// SPDX-License-Identifier: LGPL-2.1-or-later
#include "splitpads.h"

#include "wantedgrid.h"

#include <gst/tactile/tactile.h>

#include <initializer_list>
#include <utility>

namespace {

/// A branch that was unlinked during a push returns FLUSHING. That must not end the other branch.
GstFlowReturn
push(GstPad *pad, GstBuffer *buffer)
{
  const GstFlowReturn flow = gst_pad_push(pad, buffer);
  return flow == GST_FLOW_FLUSHING && !gst_pad_is_linked(pad) ? GST_FLOW_NOT_LINKED : flow;
}

/// The stream passes through: caps of both sides are the same.
gboolean
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

/// The other pad that the stream passes, from `sink` to `src` or back; from `tactile` the one by
/// which its maps come.
GstPad *
other_of(GstPad *pad)
{
  return static_cast<GstPad *>(gst_pad_get_element_private(pad));
}

/// The grid of maps that come with the stream.
bool
answer_grid(GstObject *element, GstQuery *query)
{
  g_autoptr(GstPad) tactile = gst_element_get_static_pad(GST_ELEMENT(element), "tactile");
  if (!is_grid_query(query) || !gst_pad_is_linked(tactile))
    return false;
  guint rows = 0;
  guint columns = 0;
  wanted_grid(tactile, &rows, &columns);
  answer_grid_query(query, rows, columns);
  return true;
}

gboolean
sink_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  switch (GST_QUERY_TYPE(query)) {
  case GST_QUERY_CAPS:
    return proxy_caps_query(pad, other_of(pad), query);
  case GST_QUERY_ACCEPT_CAPS:
    if (!gst_pad_is_linked(other_of(pad)))
      return gst_pad_query_default(pad, parent, query);
    return gst_pad_peer_query(other_of(pad), query);
  case GST_QUERY_ALLOCATION:
    return gst_pad_peer_query(other_of(pad), query);
  case GST_QUERY_CUSTOM:
    return answer_grid(parent, query) || gst_pad_query_default(pad, parent, query);
  default:
    return gst_pad_query_default(pad, parent, query);
  }
}

gboolean
src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS)
    return proxy_caps_query(pad, other_of(pad), query);
  return gst_pad_query_default(pad, parent, query);
}

/// Sends the event to the source of the maps: this element, or one upstream.
gboolean
pass_grid_event(GstPad *tactile, GstEvent *event)
{
  if (GstPad *sink = other_of(tactile))
    return gst_pad_push_event(sink, event);
  gst_event_unref(event);
  gst_pad_mark_reconfigure(tactile);
  return TRUE;
}

gboolean
tactile_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_QOS: // late tactors are no reason to drop pictures or sound
    gst_event_unref(event);
    return TRUE;
  case GST_EVENT_RECONFIGURE: // nor a new tactile branch one to negotiate them again
    gst_event_unref(event);
    return pass_grid_event(pad, new_grid_event());
  case GST_EVENT_CUSTOM_UPSTREAM:
    return is_grid_event(event) ? pass_grid_event(pad, event)
                                : gst_pad_event_default(pad, parent, event);
  default:
    return gst_pad_event_default(pad, parent, event);
  }
}

GstPad *
make_pad(GstElement *element, const gchar *name)
{
  return gst_pad_new_from_template(
      gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(element), name), name);
}

} // namespace

SplitPads::SplitPads(GstElement *element, const Functions &functions)
    : sink_(make_pad(element, "sink")), src_(make_pad(element, "src")),
      tactile_(make_pad(element, "tactile")), combiner_(gst_flow_combiner_new())
{
  gst_pad_set_element_private(sink_, src_);
  gst_pad_set_element_private(src_, sink_);
  gst_pad_set_element_private(tactile_, functions.maps_come ? sink_ : nullptr);
  gst_pad_set_chain_function(sink_, functions.chain);
  gst_pad_set_event_function(sink_, functions.event);
  gst_pad_set_query_function(sink_, sink_query);
  gst_pad_set_query_function(src_, src_query);
  gst_pad_set_event_function(tactile_, tactile_event);
  if (functions.tactile_query)
    gst_pad_set_query_function(tactile_, functions.tactile_query);
  gst_pad_use_fixed_caps(tactile_);
  for (GstPad *pad : { sink_, src_, tactile_ })
    gst_element_add_pad(element, pad);
  gst_flow_combiner_add_pad(combiner_, src_);
  gst_flow_combiner_add_pad(combiner_, tactile_);
}

SplitPads::~SplitPads()
{
  gst_clear_event(&segment_);
  gst_flow_combiner_unref(combiner_);
}

GstPad *
SplitPads::sink() const
{
  return sink_;
}

GstPad *
SplitPads::tactile() const
{
  return tactile_;
}

void
SplitPads::set_framerate(gint n, gint d)
{
  fps_changed_ |= n != fps_n_ || d != fps_d_;
  fps_n_ = n;
  fps_d_ = d;
}

void
SplitPads::announce(guint rows, guint columns)
{
  if (rows != rows_ || columns != columns_ || fps_changed_) {
    GstCaps *caps = gst_tactile_map_caps_new(rows, columns, fps_n_, fps_d_);
    GST_DEBUG_OBJECT(tactile_, "caps %" GST_PTR_FORMAT, caps);
    gst_pad_push_event(tactile_, gst_event_new_caps(caps));
    gst_caps_unref(caps);
    rows_ = rows;
    columns_ = columns;
    fps_changed_ = false;
  }
  if (segment_ != nullptr) {
    gst_pad_push_event(tactile_, segment_);
    segment_ = nullptr;
  }
}

void
SplitPads::announce()
{
  guint rows = rows_;
  guint columns = columns_;
  if (rows == 0)
    wanted_grid(tactile_, &rows, &columns);
  announce(rows, columns);
}

bool
SplitPads::wants_grid(guint *rows, guint *columns)
{
  if (rows_ == 0 || !gst_pad_check_reconfigure(tactile_))
    return false;
  wanted_grid(tactile_, rows, columns);
  return *rows != rows_ || *columns != columns_;
}

guint
SplitPads::rows() const
{
  return rows_;
}

guint
SplitPads::columns() const
{
  return columns_;
}

GstFlowReturn
SplitPads::maps_flow() const
{
  return gst_pad_is_linked(tactile_) ? GST_FLOW_OK : GST_FLOW_NOT_LINKED;
}

GstFlowReturn
SplitPads::push_map(GstBuffer *map)
{
  if (std::exchange(interrupted_, false))
    GST_BUFFER_FLAG_SET(map, GST_BUFFER_FLAG_DISCONT);
  return push(tactile_, map);
}

void
SplitPads::interrupt()
{
  interrupted_ = true;
}

GstFlowReturn
SplitPads::push_gap(GstClockTime pts, GstClockTime duration)
{
  tell_maps(gst_event_new_gap(pts, duration));
  return maps_flow(); // an unlinked pad counts as with a buffer
}

GstFlowReturn
SplitPads::pass(GstBuffer *buffer, GstFlowReturn of_maps)
{
  gst_flow_combiner_update_pad_flow(combiner_, tactile_, of_maps);
  return gst_flow_combiner_update_pad_flow(combiner_, src_, push(src_, buffer));
}

void
SplitPads::start_stream(GstEvent *event)
{
  const gchar *whole_id = nullptr;
  gst_event_parse_stream_start(event, &whole_id);
  gchar *id = g_strconcat(whole_id, "/tactile", nullptr);
  GstEvent *start = gst_event_new_stream_start(id);
  g_free(id);

  guint group = GST_GROUP_ID_INVALID;
  if (gst_event_parse_group_id(event, &group))
    gst_event_set_group_id(start, group);
  gst_event_set_seqnum(start, gst_event_get_seqnum(event));
  gst_pad_push_event(tactile_, start);
}

/// Serialized events come after caps and segment.
gboolean
SplitPads::tell_maps(GstEvent *event)
{
  announce();
  return gst_pad_push_event(tactile_, event);
}

gboolean
SplitPads::pass_event(GstEvent *event)
{
  gboolean handled = FALSE; // by the tactile branch: then the other one may be unlinked

  switch (GST_EVENT_TYPE(event)) {
  case GST_EVENT_STREAM_START:
    start_stream(event);
    break;
  case GST_EVENT_SEGMENT:
    interrupt();
    if (rows_ > 0)
      gst_pad_push_event(tactile_, gst_event_ref(event));
    else
      gst_event_replace(&segment_, event);
    break;
  case GST_EVENT_GAP:
  case GST_EVENT_SEGMENT_DONE:
  case GST_EVENT_EOS:
    handled = tell_maps(gst_event_ref(event));
    break;
  case GST_EVENT_STREAM_GROUP_DONE:
  case GST_EVENT_INSTANT_RATE_CHANGE:
  case GST_EVENT_FLUSH_START:
    handled = gst_pad_push_event(tactile_, gst_event_ref(event));
    break;
  case GST_EVENT_FLUSH_STOP:
    gst_flow_combiner_reset(combiner_);
    gst_clear_event(&segment_);
    interrupt();
    handled = gst_pad_push_event(tactile_, gst_event_ref(event));
    break;
  default:
    break;
  }
  return gst_pad_push_event(src_, event) || handled;
}

void
SplitPads::reset()
{
  gst_flow_combiner_reset(combiner_);
  gst_clear_event(&segment_);
  rows_ = columns_ = 0;
  fps_n_ = 0;
  fps_d_ = 1;
  fps_changed_ = false;
  interrupt();
}
