// SPDX-License-Identifier: LGPL-2.1-or-later
#include "background.h"

#include <sched.h>

/* Not by a nice value: the threads are of GLib's pool, which later serves other pipelines, and only
 * root can lower a nice value again. GLib 2.74 tries so with each thread that a streaming thread
 * adds to the pool, and prints a critical message when it fails. */
static GstBusSyncReply
on_message(GstBus *, GstMessage *message, gpointer)
{
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_STREAM_STATUS)
    return GST_BUS_PASS;
  GstStreamStatusType type = GST_STREAM_STATUS_TYPE_CREATE;
  gst_message_parse_stream_status(message, &type, nullptr);
  const sched_param none{};
  if (type == GST_STREAM_STATUS_TYPE_ENTER)
    sched_setscheduler(0, SCHED_BATCH, &none); // 0: the calling thread
  else if (type == GST_STREAM_STATUS_TYPE_LEAVE)
    sched_setscheduler(0, SCHED_OTHER, &none);
  return GST_BUS_PASS;
}

void
run_in_background(GstElement *pipeline)
{
  GstBus *bus = gst_element_get_bus(pipeline);
  gst_bus_set_sync_handler(bus, on_message, nullptr, nullptr);
  gst_object_unref(bus);
}
