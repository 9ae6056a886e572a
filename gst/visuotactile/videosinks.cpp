// SPDX-License-Identifier: LGPL-2.1-or-later
#include "videosinks.h"

#include "gst/video/video_sinks.h"

#include <functional>

static bool
may_be_tried(GstElementFactory *factory)
{
  const gchar *name = GST_OBJECT_NAME(factory);
  return g_strcmp0(name, "visuotactilesink") != 0 && g_strcmp0(name, "autovideosink") != 0
         && g_strcmp0(name, kCrashingVideoSink) != 0;
}

/* The errors on the bus of a sink that did not reach READY. */
static void
collect_errors(GstElementFactory *factory, GstBus *bus, GString *errors)
{
  while (GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    g_string_append_printf(errors, "%s: %s\n", GST_OBJECT_NAME(factory), error->message);
    gst_message_unref(message);
  }
}

GstElement *
choose_video_sink(const gchar *name, GString *errors)
{
  GList *factories = gst_element_factory_list_get_elements(
      GST_ELEMENT_FACTORY_TYPE_SINK | GST_ELEMENT_FACTORY_TYPE_MEDIA_VIDEO, GST_RANK_MARGINAL);
  factories = g_list_sort(factories, gst_plugin_feature_rank_compare_func);
  g_autoptr(GstBus) bus = gst_bus_new();
  GstElement *chosen = nullptr;

  for (GList *item = factories; item != nullptr && chosen == nullptr; item = item->next) {
    auto *factory = GST_ELEMENT_FACTORY(item->data);
    if (!may_be_tried(factory))
      continue;
    GstElement *sink = gst_element_factory_create(factory, name);
    if (sink == nullptr)
      continue;
    gst_element_set_bus(sink, bus); /* that it cannot be used is no error of the film */
    const GstStateChangeReturn ret = gst_element_set_state(sink, GST_STATE_READY);
    collect_errors(factory, bus, errors);
    /* Back to NULL, so that its requests on the way to READY (window, context) reach the
     * application. */
    gst_element_set_state(sink, GST_STATE_NULL);
    gst_element_set_bus(sink, nullptr);
    if (ret == GST_STATE_CHANGE_SUCCESS)
      chosen = sink;
    else
      gst_object_unref(gst_object_ref_sink(sink));
  }
  gst_plugin_feature_list_free(factories);
  return chosen;
}

/* Calls `visit` with the element, then with those in it if it is a bin, until it returns true. */
static bool
visit_within(GstElement *element, const std::function<bool(GstElement *)> &visit)
{
  if (visit(element))
    return true;
  if (!GST_IS_BIN(element))
    return false;
  bool found = false;
  GstIterator *children = gst_bin_iterate_recurse(GST_BIN(element));
  GValue item = G_VALUE_INIT;
  for (bool done = false; !done && !found;) {
    switch (gst_iterator_next(children, &item)) {
    case GST_ITERATOR_OK:
      found = visit(GST_ELEMENT(g_value_get_object(&item)));
      g_value_reset(&item);
      break;
    case GST_ITERATOR_RESYNC:
      gst_iterator_resync(children);
      break;
    default:
      done = true;
      break;
    }
  }
  g_value_unset(&item);
  gst_iterator_free(children);
  return found;
}

static bool
has_property(GstElement *element, const gchar *name)
{
  return g_object_class_find_property(G_OBJECT_GET_CLASS(element), name) != nullptr;
}

/* The element's name for a property, or NULL. glimagesink and waylandsink call video-direction
 * rotate-method. */
static const gchar *
own_name(GstElement *element, const gchar *name)
{
  if (has_property(element, name))
    return name;
  const bool former
      = g_str_equal(name, "video-direction") && has_property(element, "rotate-method");
  return former ? "rotate-method" : nullptr;
}

void
set_property_within(GstElement *element, const gchar *name, const GValue *value)
{
  visit_within(element, [=](GstElement *found) {
    const gchar *own = own_name(found, name);
    if (own)
      g_object_set_property(G_OBJECT(found), own, value);
    return own && found == element;
  });
}

bool
get_property_within(GstElement *element, const gchar *name, GValue *value)
{
  return visit_within(element, [=](GstElement *found) {
    const gchar *own = own_name(found, name);
    if (own)
      g_object_get_property(G_OBJECT(found), own, value);
    return own != nullptr;
  });
}

GstElement *
find_interface_within(GstElement *element, GType iface)
{
  GstElement *result = nullptr;
  visit_within(element, [iface, &result](GstElement *found) {
    if (!g_type_is_a(G_OBJECT_TYPE(found), iface))
      return false;
    result = GST_ELEMENT(gst_object_ref(found));
    return true;
  });
  return result;
}
