// SPDX-License-Identifier: LGPL-2.1-or-later
#include "background.h"

#include <initializer_list>
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

void
use_one_thread(GstElement *pipeline)
{
  g_signal_connect(
      pipeline, "deep-element-added",
      G_CALLBACK(+[](GstBin *, GstBin *, GstElement *added, gpointer) {
        for (const char *name : { "max-threads", "n-threads", "threads" })
          if (const GParamSpec *property
              = g_object_class_find_property(G_OBJECT_GET_CLASS(added), name);
              property && (property->flags & G_PARAM_WRITABLE)
              && (property->value_type == G_TYPE_INT || property->value_type == G_TYPE_UINT))
            g_object_set(added, name, 1, nullptr);
      }),
      nullptr);
}

void
decode_picture_only(GstElement *pipeline)
{
  GstElement *film = gst_bin_get_by_name(GST_BIN(pipeline), "film");
  g_autoptr(GstCaps) caps = gst_caps_from_string("video/x-raw(ANY)");
  g_object_set(film, "caps", caps, "expose-all-streams", FALSE, nullptr);
  gst_object_unref(film);
}
