// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Inherited properties: no element hides a property of its base class.
#include <initializer_list>

#include "support/check_tests.h"
#include <gst/gst.h>

namespace {

constexpr const gchar *kPlugins[] = { "saliency", "tactile", "tactor", "visuotactile" };

/// Fails if the type installs a property under a name that its parent has, too.
void
check_properties(GType type)
{
  auto *klass = static_cast<GObjectClass *>(g_type_class_ref(type));
  auto *parent = static_cast<GObjectClass *>(g_type_class_peek_parent(klass));
  guint count = 0;
  g_autofree GParamSpec **specs = g_object_class_list_properties(klass, &count);
  for (guint i = 0; i < count; i++) {
    if (specs[i]->owner_type != type || G_IS_PARAM_SPEC_OVERRIDE(specs[i]))
      continue;
    const GParamSpec *hidden = g_object_class_find_property(parent, specs[i]->name);
    fail_if(hidden, "%s hides the property '%s' of %s", g_type_name(type), specs[i]->name,
            g_type_name(hidden->owner_type));
  }
  g_type_class_unref(klass);
}

} // namespace

CHECK_TEST(test_nothing_inherited_is_hidden)
{
  guint checked = 0;
  for (const gchar *plugin : kPlugins) {
    GList *features = gst_registry_get_feature_list_by_plugin(gst_registry_get(), plugin);
    for (GList *item = features; item; item = item->next) {
      if (!GST_IS_ELEMENT_FACTORY(item->data))
        continue;
      GstPluginFeature *loaded = gst_plugin_feature_load(GST_PLUGIN_FEATURE(item->data));
      fail_unless(loaded != nullptr);
      check_properties(gst_element_factory_get_element_type(GST_ELEMENT_FACTORY(loaded)));
      gst_object_unref(loaded);
      checked++;
    }
    gst_plugin_feature_list_free(features);
  }
  fail_unless(checked >= 7, "of %u elements", checked);
}

/// tactorsink's `stats` are those of any base sink.
CHECK_TEST(test_tactorsink_has_a_sinks_stats)
{
  g_autoptr(GstElement) sink
      = GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
  const GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(sink), "stats");
  fail_unless(spec != nullptr);
  ck_assert_str_eq(g_type_name(spec->owner_type), "GstBaseSink");
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(sink, "stats", &stats, nullptr);
  for (const gchar *field : { "rendered", "dropped" })
    fail_unless(gst_structure_has_field_typed(stats, field, G_TYPE_UINT64), "%s", field);
}

CHECK_MAIN(inherited_properties)
