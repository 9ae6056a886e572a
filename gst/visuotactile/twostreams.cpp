// SPDX-License-Identifier: LGPL-2.1-or-later
#include "twostreams.h"

namespace {

constexpr const gchar *kName = "visuotactile-eos";
constexpr const gchar *kEvent = "event"; ///< the EOS itself

/// Transfer full; NULL if the event is another one.
GstEvent *
carried(GstEvent *event)
{
  GstEvent *eos = nullptr;
  if (GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_DOWNSTREAM && gst_event_has_name(event, kName))
    gst_structure_get(gst_event_get_structure(event), kEvent, GST_TYPE_EVENT, &eos, nullptr);
  return eos;
}

/// The queue's own event function.
GstPadEventFullFunction
own_function(GstPad *sink)
{
  return reinterpret_cast<GstPadEventFullFunction>(gst_pad_get_element_private(sink));
}

GstFlowReturn
sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  if (GST_EVENT_TYPE(event) != GST_EVENT_EOS)
    return own_function(pad)(pad, parent, event);
  GstEvent *carrier
      = gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM,
                             gst_structure_new(kName, kEvent, GST_TYPE_EVENT, event, nullptr));
  gst_event_set_seqnum(carrier, gst_event_get_seqnum(event));
  if (own_function(pad)(pad, parent, carrier) == GST_FLOW_OK) {
    gst_event_unref(event);
    return GST_FLOW_OK;
  }
  return own_function(pad)(pad, parent, event); // for EOS, the queue reports the reason
}

GstPadProbeReturn
src_event(GstPad *, GstPadProbeInfo *info, gpointer)
{
  GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
  if (GstEvent *eos = carried(event)) {
    gst_event_unref(event);
    info->data = eos;
  }
  return GST_PAD_PROBE_OK;
}

} // namespace

void
let_streams_follow(GstElement *queue)
{
  g_autoptr(GstPad) sink = gst_element_get_static_pad(queue, "sink");
  g_autoptr(GstPad) src = gst_element_get_static_pad(queue, "src");
  gst_pad_set_element_private(sink, reinterpret_cast<gpointer>(GST_PAD_EVENTFULLFUNC(sink)));
  gst_pad_set_event_full_function(sink, GST_DEBUG_FUNCPTR(sink_event));
  gst_pad_add_probe(src, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, src_event, nullptr, nullptr);
}
