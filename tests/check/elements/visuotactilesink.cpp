// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactilesink with a video sink made here, that tells what it was asked for. What is measured of time are running
// times: nothing depends on how fast the machine is.
#include "tactor/command_trace.h"

#include <cstdlib>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

// After the standard library's headers: gstcheck.h defines a macro named fail.
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/gstvideosink.h>
#include <gst/video/navigation.h>
#include <gst/video/videooverlay.h>

using tactor::IssuedCommand;
using tactor::Time;

/* ---- a video sink that can be looked at ---- */

struct TestVideoSink
{
  GstVideoSink parent;
  guintptr handle;
  gint x;
  gint width;
  gint exposed;
  gboolean handles_events;
  gint frames;
  std::string *navigated;
};
struct TestVideoSinkClass
{
  GstVideoSinkClass parent_class;
};

static gboolean cannot_be_used = FALSE; ///< no test sink reaches READY

static void test_video_sink_overlay_init(gpointer iface, gpointer);
static void test_video_sink_navigation_init(gpointer iface, gpointer);
GType test_video_sink_get_type(void);
G_DEFINE_TYPE_WITH_CODE(TestVideoSink, test_video_sink, GST_TYPE_VIDEO_SINK,
                        G_IMPLEMENT_INTERFACE(GST_TYPE_VIDEO_OVERLAY, test_video_sink_overlay_init)
                            G_IMPLEMENT_INTERFACE(GST_TYPE_NAVIGATION,
                                                  test_video_sink_navigation_init));

static TestVideoSink *
test_video_sink(gpointer object)
{
  fail_unless(G_TYPE_CHECK_INSTANCE_TYPE(object, test_video_sink_get_type()));
  return reinterpret_cast<TestVideoSink *>(object);
}

static void
test_video_sink_overlay_init(gpointer iface, gpointer)
{
  auto *overlay = static_cast<GstVideoOverlayInterface *>(iface);
  overlay->set_window_handle = [](GstVideoOverlay *self, guintptr handle) {
    test_video_sink(self)->handle = handle;
  };
  overlay->set_render_rectangle = [](GstVideoOverlay *self, gint x, gint, gint width, gint) {
    test_video_sink(self)->x = x;
    test_video_sink(self)->width = width;
  };
  overlay->expose = [](GstVideoOverlay *self) {
    test_video_sink(self)->exposed++;
  };
  overlay->handle_events = [](GstVideoOverlay *self, gboolean handle_events) {
    test_video_sink(self)->handles_events = handle_events;
  };
}

static void
test_video_sink_navigation_init(gpointer iface, gpointer)
{
  static_cast<GstNavigationInterface *>(iface)->send_event_simple
      = [](GstNavigation *self, GstEvent *event) {
          const gchar *key = nullptr;
          gst_navigation_event_parse_key_event(event, &key);
          *test_video_sink(self)->navigated = key;
          gst_event_unref(event);
        };
}

static gboolean
test_video_sink_start(GstBaseSink *sink)
{
  if (cannot_be_used)
    GST_ELEMENT_ERROR(sink, RESOURCE, OPEN_WRITE, ("The test's sink is broken."), (nullptr));
  return !cannot_be_used;
}

static GstStateChangeReturn
test_video_sink_change_state(GstElement *element, GstStateChange transition)
{
  if (transition == GST_STATE_CHANGE_NULL_TO_READY
      && !test_video_sink_start(GST_BASE_SINK(element)))
    return GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_NULL_TO_READY) // as glimagesink does
    gst_video_overlay_prepare_window_handle(GST_VIDEO_OVERLAY(element));
  return GST_ELEMENT_CLASS(test_video_sink_parent_class)->change_state(element, transition);
}

static void
test_video_sink_class_init(TestVideoSinkClass *klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                                          gst_caps_from_string("video/x-raw(ANY)")));
  gst_element_class_set_static_metadata(element_class, "Test's video sink", "Sink/Video", "Test",
                                        "Test");
  element_class->change_state = test_video_sink_change_state;
  // Each frame is counted once.
  GST_BASE_SINK_CLASS(klass)->preroll = [](GstBaseSink *, GstBuffer *) {
    return GST_FLOW_OK;
  };
  GST_VIDEO_SINK_CLASS(klass)->show_frame = [](GstVideoSink *sink, GstBuffer *) {
    test_video_sink(sink)->frames++;
    return GST_FLOW_OK;
  };
  GObjectClass *object_class = G_OBJECT_CLASS(klass);
  object_class->finalize = [](GObject *object) {
    delete test_video_sink(object)->navigated;
    G_OBJECT_CLASS(test_video_sink_parent_class)->finalize(object);
  };
  // Kept as data of the object: this sink has no other use for it.
  object_class->set_property = [](GObject *object, guint, const GValue *value, GParamSpec *) {
    g_object_set_data(object, "ratio", GINT_TO_POINTER(g_value_get_boolean(value) ? 1 : 2));
  };
  object_class->get_property = [](GObject *object, guint, GValue *value, GParamSpec *) {
    g_value_set_boolean(value, GPOINTER_TO_INT(g_object_get_data(object, "ratio")) != 2);
  };
  g_object_class_install_property(
      object_class, 1, g_param_spec_boolean("force-aspect-ratio", "", "", TRUE, G_PARAM_READWRITE));
}

static void
test_video_sink_init(TestVideoSink *sink)
{
  sink->handles_events = TRUE;
  sink->navigated = new std::string;
  // Frames are counted: none is left out because the machine was busy.
  gst_base_sink_set_max_lateness(GST_BASE_SINK(sink), -1);
}

/* ---- memory that cannot be read ---- */

struct DeviceAllocator
{
  GstAllocator parent;
};
struct DeviceAllocatorClass
{
  GstAllocatorClass parent_class;
};
GType device_allocator_get_type(void);
G_DEFINE_TYPE(DeviceAllocator, device_allocator, GST_TYPE_ALLOCATOR);

static void
device_allocator_class_init(DeviceAllocatorClass *klass)
{
  klass->parent_class.alloc = [](GstAllocator *allocator, gsize size, GstAllocationParams *) {
    GstMemory *memory = g_new0(GstMemory, 1);
    gst_memory_init(memory, GST_MEMORY_FLAG_NOT_MAPPABLE, allocator, nullptr, size, 0, 0, size);
    return memory;
  };
  klass->parent_class.free = [](GstAllocator *, GstMemory *memory) {
    g_free(memory);
  };
}

static void
device_allocator_init(DeviceAllocator *allocator)
{
  GST_ALLOCATOR(allocator)->mem_map = [](GstMemory *, gsize, GstMapFlags) -> gpointer {
    return nullptr;
  };
  GST_ALLOCATOR(allocator)->mem_unmap = [](GstMemory *) {
  };
}

/* ---- pipelines ---- */

namespace {

constexpr GstClockTime kMs = GST_MSECOND;

/// A ball that is felt from its first frame on.
const std::string kFilm = "tactiletestsrc name=source pattern=dynamic-motion num-buffers=60 ! "
                          "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! ";
const std::string kSink = "visuotactilesink name=chair driver=simulator "
                          "analysis::temporal=false tactors::ramp-in=0 ";

void
register_test_sink(GstRank rank)
{
  fail_unless(
      gst_element_register(nullptr, "visuotactiletestsink", rank, test_video_sink_get_type()));
}

/// The rank of every video sink but those that the test puts up is as good as none.
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

/// A pipeline with an element `chair`, and what came on its bus.
class Player
{
public:
  explicit Player(const std::string &description)
  {
    char name[] = "/tmp/visuotactilesink-XXXXXX";
    const int fd = mkstemp(name);
    fail_unless(fd >= 0);
    close(fd);
    trace_path = name;
    GError *error = nullptr;
    pipeline = gst_parse_launch(description.c_str(), &error);
    fail_unless(error == nullptr, "%s", error ? error->message : "");
    chair = gst_bin_get_by_name(GST_BIN(pipeline), "chair");
    g_object_set(chair, "trace-location", name, nullptr);
    bus = gst_element_get_bus(pipeline);
  }
  ~Player()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(bus);
    gst_object_unref(chair);
    gst_object_unref(pipeline);
    unlink(trace_path.c_str());
  }
  Player(const Player &) = delete;
  Player &operator=(const Player &) = delete;

  void set_state(GstState state)
  {
    fail_if(gst_element_set_state(pipeline, state) == GST_STATE_CHANGE_FAILURE);
    fail_if(gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE)
            == GST_STATE_CHANGE_FAILURE);
  }
  void wait_for_eos()
  {
    for (bool eos = false; !eos;) {
      GstMessage *message = gst_bus_timed_pop(bus, GST_CLOCK_TIME_NONE);
      eos = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
      take(message);
    }
  }
  void play()
  {
    set_state(GST_STATE_PLAYING);
    wait_for_eos();
    finish();
  }
  void finish()
  {
    set_state(GST_STATE_READY);
    while (GstMessage *message = gst_bus_pop(bus))
      take(message);
    gst_element_set_state(pipeline, GST_STATE_NULL);
  }
  /// What was told, every motor at zero in the end.
  std::vector<IssuedCommand> trace()
  {
    const std::vector<IssuedCommand> lines = tactor::read_command_trace(trace_path);
    std::vector<double> last(4096, 0.0);
    for (const IssuedCommand &line : lines)
      last[static_cast<std::size_t>(line.command.tactor)] = line.command.volts;
    for (const double volts : last)
      fail_unless(volts == 0);
    return lines;
  }

  GstElement *pipeline;
  GstElement *chair;
  GstBus *bus;
  std::string trace_path;
  std::vector<std::pair<std::string, std::string>> warnings; ///< whose, text

private:
  void take(GstMessage *message)
  {
    g_autoptr(GError) error = nullptr;
    g_autofree gchar *debug = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      gst_message_parse_error(message, &error, &debug);
      fail("%s: %s (%s)", GST_MESSAGE_SRC_NAME(message), error->message, debug);
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
      gst_message_parse_warning(message, &error, &debug);
      warnings.emplace_back(GST_MESSAGE_SRC_NAME(message), error->message);
    }
    gst_message_unref(message);
  }
};

GstElement *
shown_by(GstElement *chair)
{
  GstElement *sink = nullptr;
  g_object_get(chair, "video-sink", &sink, nullptr);
  fail_unless(sink != nullptr);
  gst_object_unref(sink); // the bin has it
  return sink;
}

guint
commands_with_volts(const std::vector<IssuedCommand> &lines)
{
  guint count = 0;
  for (const IssuedCommand &line : lines)
    count += line.command.volts > 0;
  return count;
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
  if (GST_IS_PARAM_SPEC_ARRAY_LIST(one)) {
    GParamSpec *item = GST_PARAM_SPEC_ARRAY_LIST(one)->element_spec;
    GParamSpec *other_item = GST_PARAM_SPEC_ARRAY_LIST(other)->element_spec;
    return G_PARAM_SPEC_INT(item)->minimum == G_PARAM_SPEC_INT(other_item)->minimum
           && G_PARAM_SPEC_INT(item)->maximum == G_PARAM_SPEC_INT(other_item)->maximum;
  }
  return true;
}

/// Type, range, default and when it may be changed are those of the child that the property is for.
GST_START_TEST(test_properties_are_the_childrens)
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
      if (g_str_equal(specs[i]->name, "stats") && g_str_equal(child_name, "analysis"))
        continue; // tactorsink's
      // What is the video sink's as well is as base sinks have it.
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
  ck_assert_uint_eq(compared, 15);
  gst_object_unref(chair);
}
GST_END_TEST;

GST_START_TEST(test_values_reach_the_children)
{
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  g_object_set(chair, "rows", 5, "max-lead", 20, "mute", TRUE, "driver", "simulator", nullptr);
  gst_util_set_object_arg(G_OBJECT(chair), "mapping", "<3,2,1>");
  gst_child_proxy_set(GST_CHILD_PROXY(chair), "tactors::max-duty", 0.25, "analysis::floor", 7.0,
                      nullptr);
  GObject *analysis = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "analysis");
  GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "tactors");
  guint rows = 0;
  guint max_lead = 0;
  gboolean mute = FALSE;
  g_autofree gchar *driver = nullptr;
  gdouble max_duty = 0;
  gdouble floor = 0;
  GValue mapping = G_VALUE_INIT;
  g_object_get(analysis, "rows", &rows, nullptr);
  g_object_get(tactors, "max-lead", &max_lead, "mute", &mute, "driver", &driver, "max-duty",
               &max_duty, nullptr);
  g_object_get_property(tactors, "mapping", &mapping);
  g_object_get(chair, "floor", &floor, nullptr);
  ck_assert_uint_eq(rows, 5);
  ck_assert_uint_eq(max_lead, 20);
  fail_unless(mute);
  ck_assert_str_eq(driver, "simulator");
  fail_unless(max_duty == 0.25);
  fail_unless(floor == 7.0);
  ck_assert_uint_eq(gst_value_array_get_size(&mapping), 3);
  g_value_unset(&mapping);
  gst_object_unref(analysis);
  gst_object_unref(tactors);
  gst_object_unref(chair);
}
GST_END_TEST;

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

GST_START_TEST(test_fan_out)
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
GST_END_TEST;

/// What is not set here is the video sink's own business, also where it is a bin.
GST_START_TEST(test_given_sink_keeps_its_properties)
{
  Player player(kFilm + kSink
                + "ts-offset=3 video-sink=\"identity ! fakesink name=inner sync=false\"");
  player.set_state(GST_STATE_READY);
  g_autoptr(GstElement) inner = gst_bin_get_by_name(GST_BIN(player.chair), "inner");
  gboolean sync = TRUE;
  gint64 offset = 0;
  g_object_get(inner, "sync", &sync, "ts-offset", &offset, nullptr);
  fail_if(sync);
  ck_assert_int_eq(offset, 3);
}
GST_END_TEST;

/* ---- the video sink ---- */

GST_START_TEST(test_overlay_and_navigation)
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
GST_END_TEST;

/// A sink without the interface leaves navigation to whoever is upstream, as a DVD's menu.
GST_START_TEST(test_navigation_upstream)
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
GST_END_TEST;

/// Nothing inside looks like a pad of the bin around it.
GST_START_TEST(test_in_a_described_bin)
{
  g_autoptr(GError) error = nullptr;
  GstElement *bin = gst_parse_bin_from_description("identity ! visuotactilesink", TRUE, &error);
  fail_unless(error == nullptr);
  ck_assert_uint_eq(bin->numsinkpads, 1);
  ck_assert_uint_eq(bin->numsrcpads, 0);
  gst_object_unref(bin);
}
GST_END_TEST;

/// The best by rank that can be used: not itself, not one that would choose in turn, not one that fails or
/// is known to crash.
GST_START_TEST(test_choice_by_rank)
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
  player.set_state(GST_STATE_READY);
  ck_assert_str_eq(G_OBJECT_TYPE_NAME(shown_by(player.chair)), "TestVideoSink");
  player.set_state(GST_STATE_NULL);
  GstElement *sink = nullptr;
  g_object_get(player.chair, "video-sink", &sink, nullptr);
  fail_unless(sink == nullptr); // chosen anew by the next play
}
GST_END_TEST;

/// A chosen sink that asks for a window as early as it can is heard.
GST_START_TEST(test_chosen_sink_asks_for_a_window)
{
  hide_other_sinks();
  register_test_sink(GST_RANK_PRIMARY);
  Player player(kFilm + kSink);
  player.set_state(GST_STATE_READY);
  bool asked = false;
  while (GstMessage *message = gst_bus_pop_filtered(player.bus, GST_MESSAGE_ELEMENT)) {
    asked |= gst_is_video_overlay_prepare_window_handle_message(message)
             && GST_MESSAGE_SRC(message) == GST_OBJECT(shown_by(player.chair));
    gst_message_unref(message);
  }
  fail_unless(asked);
}
GST_END_TEST;

/// An application that knows nothing of it: what autovideosink finds is visuotactilesink.
GST_START_TEST(test_autovideosink_chooses_it)
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
GST_END_TEST;

GST_START_TEST(test_without_a_video_sink)
{
  hide_other_sinks();
  register_test_sink(GST_RANK_PRIMARY);
  cannot_be_used = TRUE;
  Player player(kFilm + kSink);
  player.play();
  ck_assert_uint_eq(player.warnings.size(), 1);
  ck_assert_str_eq(player.warnings[0].second.c_str(),
                   "No video sink can be used: the film is felt and not shown.");
  fail_unless(commands_with_volts(player.trace()) > 0);
}
GST_END_TEST;

/* ---- the play ---- */

GST_START_TEST(test_plays_and_delays_the_picture)
{
  register_test_sink(GST_RANK_NONE);
  Player player(kFilm + kSink + "max-lead=100 video-sink=visuotactiletestsink");
  player.set_state(GST_STATE_PLAYING);
  GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(player.chair), "tactors");
  ck_assert_uint_eq(gst_base_sink_get_render_delay(GST_BASE_SINK(tactors)), 110 * kMs);
  ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(tactors)), 110 * kMs);
  ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(shown_by(player.chair))), 110 * kMs);
  gst_object_unref(tactors);
  player.wait_for_eos();
  ck_assert_int_eq(test_video_sink(shown_by(player.chair))->frames, 60);
  player.finish();
  fail_unless(player.warnings.empty());
  const std::vector<IssuedCommand> lines = player.trace();
  fail_unless(commands_with_volts(lines) > 0);
  for (const IssuedCommand &line : lines) {
    fail_unless(line.command.lead <= std::chrono::milliseconds(100));
    fail_unless(line.command.effect <= std::chrono::seconds(2));
  }
}
GST_END_TEST;

/// Live, the picture is later than its source by what the motors need and 10 ms, and by nothing else: so also when `max-lead` is
/// small, and behind a network.
static void
check_live(const std::string &source, guint max_lead, GstClockTime at_least)
{
  Player player(source + kSink
                + "video-sink=visuotactiletestsink max-lead=" + std::to_string(max_lead));
  player.set_state(GST_STATE_PLAYING);
  // A live pipeline is in PLAYING before anything has come.
  while (test_video_sink(shown_by(player.chair))->frames < 2)
    g_usleep(1000);
  gboolean live = FALSE;
  GstClockTime upstream = 0;
  auto *screen = GST_BASE_SINK(shown_by(player.chair));
  fail_unless(gst_base_sink_query_latency(screen, nullptr, &live, &upstream, nullptr));
  fail_unless(live);
  GstQuery *query = gst_query_new_latency();
  g_autoptr(GstPad) pad = gst_element_get_static_pad(player.chair, "sink");
  fail_unless(gst_pad_peer_query(pad, query));
  GstClockTime source_latency = 0;
  gst_query_parse_latency(query, nullptr, &source_latency, nullptr);
  gst_query_unref(query);
  fail_unless(source_latency >= at_least);
  // A live pipeline also grants its elements time to work in, 20 ms; 15 with a video sink alone.
  GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(player.chair), "tactors");
  const GstClockTime work = gst_base_sink_get_processing_deadline(GST_BASE_SINK(tactors));
  gst_object_unref(tactors);
  ck_assert_uint_eq(gst_base_sink_get_latency(screen),
                    source_latency + work + (max_lead + 10) * kMs);
}

GST_START_TEST(test_live)
{
  register_test_sink(GST_RANK_NONE);
  const std::string camera = "tactiletestsrc pattern=dynamic-motion is-live=true ! "
                             "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! ";
  check_live(camera, 180, 0);
  check_live(camera, 20, 0);
  check_live(camera + "rtpvrawpay ! rtpjitterbuffer latency=50 ! rtpvrawdepay ! ", 180, 50 * kMs);
}
GST_END_TEST;

/// Neither a board that is not there nor one that fails stops the film; the next play tries again.
GST_START_TEST(test_plays_without_tactors)
{
  register_test_sink(GST_RANK_NONE);
  const std::string sink = kSink + "video-sink=visuotactiletestsink ";
  Player player(kFilm + sink + "device=/does/not/exist/amplitude.csv");
  player.set_state(GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_int_eq(test_video_sink(shown_by(player.chair))->frames, 60);
  player.finish();
  ck_assert_uint_eq(player.warnings.size(), 1);
  fail_unless(player.warnings[0].first == "tactors");
  fail_unless(g_str_has_prefix(player.warnings[0].second.c_str(), "The film plays without touch: "),
              "%s", player.warnings[0].second.c_str());

  g_object_set(player.chair, "device", nullptr, nullptr);
  player.play();
  ck_assert_uint_eq(player.warnings.size(), 1);
  fail_unless(commands_with_volts(player.trace()) > 0);

  // A board that fails in the middle: its amplitudes go to a full disk.
  g_object_set(player.chair, "device", "/dev/full", nullptr);
  player.set_state(GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_int_eq(test_video_sink(shown_by(player.chair))->frames, 180);
  player.finish();
  ck_assert_uint_eq(player.warnings.size(), 2);
  player.trace();
}
GST_END_TEST;

/// Frames that wait for their motors are not there for the decoder: it is told so.
GST_START_TEST(test_asks_for_more_buffers)
{
  GstHarness *harness
      = gst_harness_new_parse("visuotactilesink driver=simulator async=false video-sink=fakesink");
  gst_harness_set_src_caps_str(harness,
                               "video/x-raw,format=I420,width=64,height=64,framerate=50/1");
  g_autoptr(GstCaps) caps
      = gst_caps_from_string("video/x-raw,format=I420,width=64,height=64,framerate=50/1");
  GstQuery *query = gst_query_new_allocation(caps, TRUE);
  fail_unless(gst_pad_peer_query(harness->srcpad, query));
  guint least = 0;
  fail_unless(gst_query_get_n_allocation_pools(query) > 0);
  gst_query_parse_nth_allocation_pool(query, 0, nullptr, nullptr, &least, nullptr);
  ck_assert_uint_ge(least, 11); // 190 ms at 50 frames a second, 9.5, and the one at hand
  gst_query_unref(query);
  gst_harness_teardown(harness);
}
GST_END_TEST;

/// Memory that only a device can read: shown and not felt, and said once.
GST_START_TEST(test_unreadable_memory)
{
  register_test_sink(GST_RANK_NONE);
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  g_object_set(chair, "driver", "simulator", "sync", FALSE, "async", FALSE, "video-sink",
               gst_element_factory_make("visuotactiletestsink", nullptr), nullptr);
  GstHarness *harness = gst_harness_new_with_element(chair, "sink", nullptr);
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(chair, bus);
  gst_harness_set_src_caps_str(
      harness, "video/x-raw(memory:Device),format=NV12,width=64,height=64,framerate=30/1");
  gst_harness_play(harness);
  g_autoptr(GstAllocator) allocator
      = GST_ALLOCATOR(gst_object_ref_sink(g_object_new(device_allocator_get_type(), nullptr)));
  for (guint i = 0; i < 5; i++) {
    GstBuffer *buffer = gst_buffer_new();
    GstMemory *memory = gst_allocator_alloc(allocator, 64 * 64 * 3 / 2, nullptr);
    gst_buffer_append_memory(buffer, memory);
    GST_BUFFER_PTS(buffer) = i * 33 * kMs;
    GST_BUFFER_DURATION(buffer) = 33 * kMs;
    ck_assert_int_eq(gst_harness_push(harness, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event(harness, gst_event_new_eos());
  guint warnings = 0;
  for (bool eos = false; !eos;) {
    GstMessage *message = gst_bus_timed_pop(bus, GST_CLOCK_TIME_NONE);
    warnings += GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING;
    fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR);
    eos = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    gst_message_unref(message);
  }
  ck_assert_uint_eq(warnings, 1);
  ck_assert_int_eq(test_video_sink(shown_by(chair))->frames, 5);
  gst_element_set_bus(chair, nullptr);
  gst_harness_teardown(harness);
  gst_object_unref(chair);
}
GST_END_TEST;

/// In a pause a user looks at one frame after the other, more than the queues hold: the motors, which stand, do not stop that.
GST_START_TEST(test_frames_are_stepped_through)
{
  Player player(kFilm + kSink + "video-sink=fakesink");
  player.set_state(GST_STATE_PAUSED);
  GstElement *shown = shown_by(player.chair);
  for (int i = 0; i < 40; i++) {
    fail_unless(
        gst_element_send_event(shown, gst_event_new_step(GST_FORMAT_BUFFERS, 1, 1.0, TRUE, FALSE)));
    ck_assert_int_eq(gst_element_get_state(player.pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE),
                     GST_STATE_CHANGE_SUCCESS);
  }
  gint64 position = 0;
  fail_unless(gst_element_query_position(shown, GST_FORMAT_TIME, &position));
  fail_unless(position >= static_cast<gint64>(GST_SECOND));
  player.play();
  player.trace();
}
GST_END_TEST;

static Suite *
visuotactilesink_suite(void)
{
  Suite *suite = suite_create("visuotactilesink");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_test(cases, test_properties_are_the_childrens);
  tcase_add_test(cases, test_values_reach_the_children);
  tcase_add_test(cases, test_fan_out);
  tcase_add_test(cases, test_given_sink_keeps_its_properties);
  tcase_add_test(cases, test_overlay_and_navigation);
  tcase_add_test(cases, test_navigation_upstream);
  tcase_add_test(cases, test_in_a_described_bin);
  tcase_add_test(cases, test_choice_by_rank);
  tcase_add_test(cases, test_chosen_sink_asks_for_a_window);
  tcase_add_test(cases, test_autovideosink_chooses_it);
  tcase_add_test(cases, test_without_a_video_sink);
  tcase_add_test(cases, test_plays_and_delays_the_picture);
  tcase_add_test(cases, test_live);
  tcase_add_test(cases, test_plays_without_tactors);
  tcase_add_test(cases, test_asks_for_more_buffers);
  tcase_add_test(cases, test_unreadable_memory);
  tcase_add_test(cases, test_frames_are_stepped_through);
  return suite;
}

GST_CHECK_MAIN(visuotactilesink);
