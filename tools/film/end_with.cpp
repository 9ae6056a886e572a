// SPDX-License-Identifier: LGPL-2.1-or-later
#include "end_with.h"

#include "pipeline.h"

void
end_with(GstElement *chair, GstElement *film)
{
  const Owned<GstPad> pad(gst_element_get_static_pad(film, "src"));
  gst_pad_add_probe(
      pad.get(), GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
      +[](GstPad *, GstPadProbeInfo *info, gpointer sink) {
        if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS)
          // On another thread. The chair may wait for a cue, which a flush ends.
          gst_element_call_async(
              GST_ELEMENT(sink),
              +[](GstElement *self, gpointer) {
                const Owned<GstPad> input(gst_element_get_static_pad(self, "sink"));
                gst_pad_send_event(input.get(), gst_event_new_flush_start());
                gst_pad_send_event(input.get(), gst_event_new_flush_stop(FALSE));
                gst_pad_send_event(input.get(), gst_event_new_eos());
              },
              nullptr, nullptr);
        return GST_PAD_PROBE_OK;
      },
      gst_object_ref(chair), gst_object_unref);
}
