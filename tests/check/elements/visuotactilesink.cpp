// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactilesink as a player's video sink: its properties, its choice of a video sink, windows
// and keys. visuotactilesink_playing tests how it plays.
#include "visuotactilesink_rig.h"

#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

namespace {

/// Lowers the rank of all video sinks except the test's own.
void
hide_other_sinks()
{
  GList *factories = gst_element_factory_list_get_elements(
      GST_ELEMENT_FACTORY_TYPE_SINK | GST_ELEMENT_FACTORY_TYPE_MEDIA_VIDEO, GST_RANK_MARGINAL);
  for (GList *item = factories; item; item = item->next)
    gst_plugin_feature_set_rank(GST_PLUGIN_FEATURE(item->data), GST_RANK_NONE);
  gst_plugin_feature_list_free(factories);
}

void
set_own_rank(guint rank)
{
  g_autoptr(GstElementFactory) factory = gst_element_factory_find("visuotactilesink");
  fail_unless(factory != nullptr);
  gst_plugin_feature_set_rank(GST_PLUGIN_FEATURE(factory), rank);
}

} // namespace

/* ---- properties ---- */

static bool
same_range(GParamSpec *one, GParamSpec *other)
{
  if (G_IS_PARAM_SPEC_UINT(one))
    return G_PARAM_SPEC_UINT(one)->minimum == G_PARAM_SPEC_UINT(other)->minimum
           && G_PARAM_SPEC_UINT(one)->maximum == G_PARAM_SPEC_UINT(other)->maximum;
  if (G_IS_PARAM_SPEC_DOUBLE(one))
    return G_PARAM_SPEC_DOUBLE(one)->minimum == G_PARAM_SPEC_DOUBLE(other)->minimum
           && G_PARAM_SPEC_DOUBLE(one)->maximum == G_PARAM_SPEC_DOUBLE(other)->maximum;
  if (G_IS_PARAM_SPEC_UINT64(one))
    return G_PARAM_SPEC_UINT64(one)->minimum == G_PARAM_SPEC_UINT64(other)->minimum
           && G_PARAM_SPEC_UINT64(one)->maximum == G_PARAM_SPEC_UINT64(other)->maximum;
  return true;
}

/// Type, range, default and flags of a property equal those of the child's property.
CHECK_TEST(test_properties_are_the_childrens)
{
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  guint count = 0;
  g_autofree GParamSpec **specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(chair), &count);
  guint compared = 0;
  for (const char *child_name : { "analysis", "tactors" }) {
    GObject *child = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), child_name);
    fail_unless(child != nullptr);
    for (guint i = 0; i < count; i++) {
      if (specs[i]->owner_type != G_OBJECT_TYPE(chair))
        continue;
      // Properties that the child inherits from the base sink are not compared.
      GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(child), specs[i]->name);
      if (!spec || spec->owner_type != G_OBJECT_TYPE(child))
        continue;
      compared++;
      fail_unless(spec->value_type == specs[i]->value_type, "%s", spec->name);
      fail_unless(g_param_values_cmp(spec, g_param_spec_get_default_value(spec),
                                     g_param_spec_get_default_value(specs[i]))
                      == 0,
                  "%s", spec->name);
      fail_unless(same_range(spec, specs[i]), "%s", spec->name);
      constexpr guint kWhen = GST_PARAM_MUTABLE_READY | GST_PARAM_MUTABLE_PLAYING;
      ck_assert_uint_eq(spec->flags & kWhen, specs[i]->flags & kWhen);
    }
    gst_object_unref(child);
  }
  ck_assert_uint_eq(compared, 23);
  gst_object_unref(chair);
}

CHECK_TEST(test_values_reach_the_children)
{
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  g_object_set(chair, "rows", 5, "max-lead", 20 * GST_MSECOND, "mute", TRUE, "driver", "simulator",
               "mapping", "<3, 2, 1>", nullptr);
  gst_child_proxy_set(GST_CHILD_PROXY(chair), "tactors::max-duty", 0.25, "analysis::floor", 7.0,
                      nullptr);
  GObject *analysis = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "analysis");
  GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "tactors");
  guint rows = 0;
  guint64 max_lead = 0;
  gboolean mute = FALSE;
  g_autofree gchar *driver = nullptr;
  gdouble max_duty = 0;
  gdouble floor = 0;
  g_autofree gchar *mapping = nullptr;
  g_object_get(analysis, "rows", &rows, nullptr);
  g_object_get(tactors, "max-lead", &max_lead, "mute", &mute, "driver", &driver, "max-duty",
               &max_duty, "mapping", &mapping, nullptr);
  g_object_get(chair, "floor", &floor, nullptr);
  ck_assert_uint_eq(rows, 5);
  ck_assert_uint_eq(max_lead, 20 * GST_MSECOND);
  fail_unless(mute);
  ck_assert_str_eq(driver, "simulator");
  fail_unless(max_duty == 0.25);
  fail_unless(floor == 7.0);
  ck_assert_str_eq(mapping, "3,2,1");
  gst_object_unref(analysis);
  gst_object_unref(tactors);
  gst_object_unref(chair);
}

static void
assert_fanned_out(GstElement *chair)
{
  GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "tactors");
  const gpointer objects[] = { chair, tactors, shown_by(chair) };
  for (gpointer object : objects) {
    gint64 offset = 0;
    gboolean async = TRUE;
    gboolean sync = TRUE;
    g_object_get(object, "ts-offset", &offset, "async", &async, "sync", &sync, nullptr);
    ck_assert_int_eq(offset, -7);
    fail_if(async);
    fail_if(sync);
  }
  gboolean ratio = TRUE;
  g_object_get(shown_by(chair), "force-aspect-ratio", &ratio, nullptr);
  fail_if(ratio);
  gst_object_unref(tactors);
}

CHECK_TEST(test_fan_out)
{
  register_test_sink(GST_RANK_NONE);
  for (const bool before : { true, false }) {
    GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
    GstElement *sink = gst_element_factory_make("visuotactiletestsink", nullptr);
    g_object_set(chair, "video-sink", sink, nullptr);
    const auto set = [=] {
      g_object_set(chair, "ts-offset", gint64{ -7 }, "async", FALSE, "sync", FALSE,
                   "force-aspect-ratio", FALSE, nullptr);
    };
    if (before)
      set();
    fail_unless(gst_element_set_state(chair, GST_STATE_READY) == GST_STATE_CHANGE_SUCCESS);
    if (!before)
      set();
    assert_fanned_out(chair);
    gst_element_set_state(chair, GST_STATE_NULL);
    gst_object_unref(chair);
  }
}

static void
assert_direction(gpointer object, const gchar *property, GstVideoOrientationMethod expected)
{
  gint direction = -1;
  g_object_get(object, property, &direction, nullptr);
  ck_assert_int_eq(direction, expected);
}

/// Picture and grid are rotated together. A given video sink is only set if the user sets the
/// property.
CHECK_TEST(test_video_direction)
{
  hide_other_sinks();
  register_test_sink(GST_RANK_PRIMARY);
  for (const bool given : { true, false }) {
    GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
    if (given)
      g_object_set(chair, "video-sink", gst_element_factory_make("visuotactiletestsink", nullptr),
                   nullptr);
    fail_unless(gst_element_set_state(chair, GST_STATE_READY) == GST_STATE_CHANGE_SUCCESS);
    assert_direction(shown_by(chair), "rotate-method",
                     given ? GST_VIDEO_ORIENTATION_IDENTITY : GST_VIDEO_ORIENTATION_AUTO);
    assert_direction(chair, "video-direction", GST_VIDEO_ORIENTATION_AUTO);
    g_object_set(chair, "video-direction", GST_VIDEO_ORIENTATION_90L, nullptr);
    GObject *analysis = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "analysis");
    assert_direction(analysis, "video-direction", GST_VIDEO_ORIENTATION_90L);
    assert_direction(shown_by(chair), "rotate-method", GST_VIDEO_ORIENTATION_90L);
    gst_object_unref(analysis);
    gst_element_set_state(chair, GST_STATE_NULL);
    gst_object_unref(chair);
  }
}

static GstPadProbeReturn
keep_levels(GstPad *, GstPadProbeInfo *info, gpointer data)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(GST_PAD_PROBE_INFO_BUFFER(info));
  fail_unless(meta != nullptr && meta->rows == 3 && meta->columns == 3);
  static_cast<std::vector<gfloat> *>(data)->insert(static_cast<std::vector<gfloat> *>(data)->end(),
                                                   meta->levels, meta->levels + 9);
  return GST_PAD_PROBE_OK;
}

/// A tag from upstream rotates the maps of the whole film.
CHECK_TEST(test_phone_film)
{
  const auto levels_of_film = [](const std::string &orientation) {
    std::vector<gfloat> levels;
    Player player(kFilm + "taginject tags=image-orientation=" + orientation + " ! " + kSink
                  + "sync=false video-sink=fakesink");
    change_state(player.pipeline, GST_STATE_READY);
    g_autoptr(GstPad) pad = gst_element_get_static_pad(shown_by(player.chair), "sink");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, keep_levels, &levels, nullptr);
    player.play();
    return levels;
  };
  const std::vector<gfloat> stored = levels_of_film("rotate-0");
  const std::vector<gfloat> turned = levels_of_film("rotate-90");
  ck_assert_uint_eq(stored.size(), 60 * 9);
  ck_assert_uint_eq(turned.size(), stored.size());
  bool felt = false;
  for (std::size_t i = 0; i < stored.size(); i++) {
    const std::size_t cell = i % 9;
    const std::size_t frame = i - cell;
    // Clockwise: the stored bottom row is the left column on the screen.
    fail_unless(turned[i] == stored[frame + (2 - cell % 3) * 3 + cell / 3]);
    felt |= turned[i] != stored[i];
  }
  fail_unless(felt);
}

/// Properties that are not set here keep the given sink's values, also if it is a bin.
CHECK_TEST(test_given_sink_keeps_its_properties)
{
  Player player(kFilm + kSink
                + "ts-offset=3 video-sink=\"identity ! fakesink name=inner sync=false\"");
  change_state(player.pipeline, GST_STATE_READY);
  g_autoptr(GstElement) inner = gst_bin_get_by_name(GST_BIN(player.chair), "inner");
  gboolean sync = TRUE;
  gint64 offset = 0;
  g_object_get(inner, "sync", &sync, "ts-offset", &offset, nullptr);
  fail_if(sync);
  ck_assert_int_eq(offset, 3);
}

/* ---- the video sink ---- */

CHECK_TEST(test_overlay_and_navigation)
{
  register_test_sink(GST_RANK_NONE);
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  GstVideoOverlay *overlay = GST_VIDEO_OVERLAY(chair);
  g_object_set(chair, "video-sink", gst_element_factory_make("visuotactiletestsink", nullptr),
               nullptr);
  gst_video_overlay_set_window_handle(overlay, 42);
  gst_video_overlay_set_render_rectangle(overlay, 1, 2, 30, 40);
  gst_video_overlay_handle_events(overlay, FALSE);
  gst_element_set_state(chair, GST_STATE_READY);
  TestVideoSink *sink = test_video_sink(shown_by(chair));
  ck_assert_uint_eq(sink->handle, 42);
  ck_assert_int_eq(sink->x, 1);
  ck_assert_int_eq(sink->width, 30);
  fail_if(sink->handles_events);

  gst_video_overlay_set_window_handle(overlay, 43);
  gst_video_overlay_set_render_rectangle(overlay, 5, 6, 70, 80);
  gst_video_overlay_handle_events(overlay, TRUE);
  gst_video_overlay_expose(overlay);
  gst_navigation_send_event_simple(GST_NAVIGATION(chair),
                                   gst_navigation_event_new_key_press("Left", {}));
  ck_assert_uint_eq(sink->handle, 43);
  ck_assert_int_eq(sink->x, 5);
  ck_assert_int_eq(sink->width, 70);
  fail_unless(sink->handles_events);
  ck_assert_int_eq(sink->exposed, 1);
  ck_assert_str_eq(sink->navigated->c_str(), "Left");
  gst_element_set_state(chair, GST_STATE_NULL);
  gst_object_unref(chair);
}

/// If the sink lacks the interface, navigation events go upstream, for instance to a DVD's menu.
CHECK_TEST(test_navigation_upstream)
{
  GstHarness *harness = gst_harness_new_parse(
      "visuotactilesink name=chair driver=simulator async=false video-sink=fakesink");
  g_autoptr(GstElement) chair = gst_bin_get_by_name(GST_BIN(harness->element), "chair");
  if (!chair)
    chair = GST_ELEMENT(gst_object_ref(harness->element));
  gst_harness_play(harness);
  while (GstEvent *event = gst_harness_try_pull_upstream_event(harness))
    gst_event_unref(event);
  gst_navigation_send_event_simple(GST_NAVIGATION(chair),
                                   gst_navigation_event_new_key_press("Left", {}));
  GstEvent *event = gst_harness_pull_upstream_event(harness);
  ck_assert_int_eq(GST_EVENT_TYPE(event), GST_EVENT_NAVIGATION);
  gst_event_unref(event);
  gst_harness_teardown(harness);
}

/// No pad inside becomes a ghost pad of the surrounding bin.
CHECK_TEST(test_in_a_described_bin)
{
  g_autoptr(GError) error = nullptr;
  GstElement *bin = gst_parse_bin_from_description("identity ! visuotactilesink", TRUE, &error);
  fail_unless(error == nullptr);
  ck_assert_uint_eq(bin->numsinkpads, 1);
  ck_assert_uint_eq(bin->numsrcpads, 0);
  gst_object_unref(bin);
}

/// The highest-ranked usable sink is chosen: not itself, not one that would choose in turn, and not
/// one that fails or is known to crash.
CHECK_TEST(test_choice_by_rank)
{
  hide_other_sinks();
  register_test_sink(static_cast<GstRank>(GST_RANK_PRIMARY + 100));
  GTypeQuery query;
  g_type_query(test_video_sink_get_type(), &query);
  const GType crashing = g_type_register_static_simple(
      test_video_sink_get_type(), "CrashingSink", query.class_size, nullptr, query.instance_size,
      nullptr, static_cast<GTypeFlags>(0));
  fail_unless(gst_element_register(nullptr, "dfbvideosink", GST_RANK_PRIMARY + 200, crashing));
  set_own_rank(G_MAXINT);
  g_autoptr(GstElementFactory) automatic = gst_element_factory_find("autovideosink");
  fail_unless(automatic != nullptr);
  gst_plugin_feature_set_rank(GST_PLUGIN_FEATURE(automatic), G_MAXINT);

  Player player(kFilm + kSink);
  change_state(player.pipeline, GST_STATE_READY);
  ck_assert_str_eq(G_OBJECT_TYPE_NAME(shown_by(player.chair)), "TestVideoSink");
  change_state(player.pipeline, GST_STATE_NULL);
  GstElement *sink = nullptr;
  g_object_get(player.chair, "video-sink", &sink, nullptr);
  fail_unless(sink == nullptr); // chosen again for the next play
}

/// A chosen sink may ask for a window at its first state change: the message arrives.
CHECK_TEST(test_chosen_sink_asks_for_a_window)
{
  hide_other_sinks();
  register_test_sink(GST_RANK_PRIMARY);
  Player player(kFilm + kSink);
  change_state(player.pipeline, GST_STATE_READY);
  bool asked = false;
  while (GstMessage *message = gst_bus_pop_filtered(player.bus, GST_MESSAGE_ELEMENT)) {
    asked |= gst_is_video_overlay_prepare_window_handle_message(message)
             && GST_MESSAGE_SRC(message) == GST_OBJECT(shown_by(player.chair));
    gst_message_unref(message);
  }
  fail_unless(asked);
}

/// For applications that do not know it: autovideosink chooses visuotactilesink.
CHECK_TEST(test_autovideosink_chooses_it)
{
  hide_other_sinks();
  register_test_sink(GST_RANK_PRIMARY);
  set_own_rank(G_MAXINT);
  GstElement *automatic = gst_element_factory_make("autovideosink", nullptr);
  fail_unless(gst_element_set_state(automatic, GST_STATE_READY) == GST_STATE_CHANGE_SUCCESS);
  GstIterator *sinks = gst_bin_iterate_sinks(GST_BIN(automatic));
  GValue item = G_VALUE_INIT;
  fail_unless(gst_iterator_next(sinks, &item) == GST_ITERATOR_OK);
  auto *chair = GST_ELEMENT(g_value_get_object(&item));
  ck_assert_str_eq(G_OBJECT_TYPE_NAME(chair), "GstVisuotactileSink");
  ck_assert_str_eq(G_OBJECT_TYPE_NAME(shown_by(chair)), "TestVideoSink");
  g_value_unset(&item);
  gst_iterator_free(sinks);
  gst_element_set_state(automatic, GST_STATE_NULL);
  gst_object_unref(automatic);
}

CHECK_TEST(test_without_a_video_sink)
{
  hide_other_sinks();
  register_test_sink(GST_RANK_PRIMARY);
  cannot_be_used = TRUE;
  Player player(kFilm + kSink);
  player.play();
  ck_assert_uint_eq(player.warnings.size(), 1);
  ck_assert_str_eq(player.warnings[0].second.c_str(),
                   "No video sink can be used: the film is felt, but not shown.");
  fail_unless(commands_with_volts(player.trace()) > 0);
}

CHECK_MAIN(visuotactilesink)
