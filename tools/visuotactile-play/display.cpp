// SPDX-License-Identifier: LGPL-2.1-or-later
#include "display.h"

#include "film/pipeline.h"
#include "gst/video/video_sinks.h"

std::string
video_sink()
{
  if (!g_getenv("DISPLAY") && !g_getenv("WAYLAND_DISPLAY"))
    return {};
  // autovideosink would try it.
  if (GstPluginFeature *feature
      = gst_registry_lookup_feature(gst_registry_get(), kCrashingVideoSink)) {
    gst_plugin_feature_set_rank(feature, GST_RANK_NONE);
    gst_object_unref(feature);
  }
  // autovideosink opens the best sink that works, or settles for a fake one.
  const Owned<GstElement> sink(gst_element_factory_make("autovideosink", nullptr));
  if (!sink)
    return {};
  gst_object_ref_sink(sink.get());
  std::string found;
  if (gst_element_set_state(sink.get(), GST_STATE_READY) != GST_STATE_CHANGE_FAILURE) {
    GstIterator *children = gst_bin_iterate_elements(GST_BIN(sink.get()));
    GValue item = G_VALUE_INIT;
    while (gst_iterator_next(children, &item) == GST_ITERATOR_OK) {
      const GstElementFactory *factory
          = gst_element_get_factory(GST_ELEMENT(g_value_get_object(&item)));
      if (factory && !g_str_has_prefix(GST_OBJECT_NAME(factory), "fake"))
        found = GST_OBJECT_NAME(factory);
      g_value_unset(&item);
    }
    gst_iterator_free(children);
  }
  gst_element_set_state(sink.get(), GST_STATE_NULL);
  return found;
}
