// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sinkwindow.h"

#include "videosinks.h"

#include <gst/video/navigation.h>
#include <gst/video/videooverlay.h>

/// The element in the video sink with GstVideoOverlay, or NULL. Transfer full.
static GstElement *
gst_visuotactile_sink_ref_overlay(GstVisuotactileSink *self)
{
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  return shown ? find_interface_within(shown, GST_TYPE_VIDEO_OVERLAY) : nullptr;
}

static void
gst_visuotactile_sink_set_window_handle(GstVideoOverlay *overlay, guintptr handle)
{
  auto *self = GST_VISUOTACTILE_SINK_CAST(overlay);
  GST_OBJECT_LOCK(self);
  self->window.has_handle = TRUE;
  self->window.handle = handle;
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(self);
  if (shown)
    gst_video_overlay_set_window_handle(GST_VIDEO_OVERLAY(shown), handle);
}

static void
gst_visuotactile_sink_set_render_rectangle(GstVideoOverlay *overlay, gint x, gint y, gint width,
                                           gint height)
{
  auto *self = GST_VISUOTACTILE_SINK_CAST(overlay);
  GST_OBJECT_LOCK(self);
  self->window.has_rectangle = TRUE;
  self->window.rectangle = { x, y, width, height };
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(self);
  if (shown)
    gst_video_overlay_set_render_rectangle(GST_VIDEO_OVERLAY(shown), x, y, width, height);
}

static void
gst_visuotactile_sink_handle_events(GstVideoOverlay *overlay, gboolean handle_events)
{
  auto *self = GST_VISUOTACTILE_SINK_CAST(overlay);
  GST_OBJECT_LOCK(self);
  self->window.ignores_events = !handle_events;
  GST_OBJECT_UNLOCK(self);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_overlay(self);
  if (shown)
    gst_video_overlay_handle_events(GST_VIDEO_OVERLAY(shown), handle_events);
}

static void
gst_visuotactile_sink_expose(GstVideoOverlay *overlay)
{
  g_autoptr(GstElement) shown
      = gst_visuotactile_sink_ref_overlay(GST_VISUOTACTILE_SINK_CAST(overlay));
  if (shown)
    gst_video_overlay_expose(GST_VIDEO_OVERLAY(shown));
}

void
gst_visuotactile_sink_overlay_init(gpointer iface, gpointer)
{
  auto *overlay = static_cast<GstVideoOverlayInterface *>(iface);
  overlay->set_window_handle = gst_visuotactile_sink_set_window_handle;
  overlay->set_render_rectangle = gst_visuotactile_sink_set_render_rectangle;
  overlay->handle_events = gst_visuotactile_sink_handle_events;
  overlay->expose = gst_visuotactile_sink_expose;
}

void
gst_visuotactile_sink_apply_window(GstVisuotactileSink *self, GstElement *shown)
{
  g_autoptr(GstElement) element = find_interface_within(shown, GST_TYPE_VIDEO_OVERLAY);
  GST_OBJECT_LOCK(self);
  const SinkWindow window = self->window;
  GST_OBJECT_UNLOCK(self);
  if (element == nullptr)
    return;
  GstVideoOverlay *overlay = GST_VIDEO_OVERLAY(element);
  if (window.has_handle)
    gst_video_overlay_set_window_handle(overlay, window.handle);
  if (window.has_rectangle)
    gst_video_overlay_set_render_rectangle(overlay, window.rectangle.x, window.rectangle.y,
                                           window.rectangle.w, window.rectangle.h);
  if (window.ignores_events)
    gst_video_overlay_handle_events(overlay, FALSE);
}

/// To the video sink, which maps window to picture coordinates; without one, upstream unchanged.
static void
gst_visuotactile_sink_send_navigation(GstNavigation *navigation, GstEvent *event)
{
  auto *self = GST_VISUOTACTILE_SINK_CAST(navigation);
  g_autoptr(GstElement) shown = gst_visuotactile_sink_ref_shown(self);
  g_autoptr(GstElement) inner = shown ? find_interface_within(shown, GST_TYPE_NAVIGATION) : nullptr;
  if (inner)
    gst_navigation_send_event_simple(GST_NAVIGATION(inner), event);
  else
    gst_pad_push_event(self->sinkpad, event);
}

void
gst_visuotactile_sink_navigation_init(gpointer iface, gpointer)
{
  auto *navigation = static_cast<GstNavigationInterface *>(iface);
  navigation->send_event_simple = gst_visuotactile_sink_send_navigation;
}
