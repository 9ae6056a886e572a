// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactilesink playing: the picture's delay, live streams, a film without tactors, unreadable
// memory. Times are running times, so no test depends on the machine's speed.
#include <atomic>
#include <future>
#include <thread>

#include "visuotactilesink_rig.h"

#include "support/check_tests.h"

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

/* ---- the play ---- */

CHECK_TEST(test_plays_and_delays_the_picture)
{
  register_test_sink(GST_RANK_NONE);
  Player player(kFilm + kSink + "max-lead=100000000 video-sink=visuotactiletestsink");
  change_state(player.pipeline, GST_STATE_PLAYING);
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

/// In a live stream the picture is later than its source by max-lead and 10 ms, and by nothing
/// else. This holds for a small max-lead and behind a network, too.
static void
check_live(const std::string &source, GstClockTime max_lead, GstClockTime at_least)
{
  Player player(source + kSink
                + "video-sink=visuotactiletestsink max-lead=" + std::to_string(max_lead));
  change_state(player.pipeline, GST_STATE_PLAYING);
  // A live pipeline reaches PLAYING before any frame arrives.
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
  // A live pipeline adds its elements' processing deadline: 20 ms, or 15 ms with a video sink
  // alone.
  GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(player.chair), "tactors");
  const GstClockTime work = gst_base_sink_get_processing_deadline(GST_BASE_SINK(tactors));
  gst_object_unref(tactors);
  ck_assert_uint_eq(gst_base_sink_get_latency(screen), source_latency + work + max_lead + 10 * kMs);
}

CHECK_TEST(test_live)
{
  register_test_sink(GST_RANK_NONE);
  const std::string camera = "tactiletestsrc pattern=dynamic-motion is-live=true ! "
                             "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! ";
  check_live(camera, 180 * kMs, 0);
  check_live(camera, 20 * kMs, 0);
  check_live(camera + "rtpvrawpay ! rtpjitterbuffer latency=50 ! rtpvrawdepay ! ", 180 * kMs,
             50 * kMs);
}

/// A board that is missing or fails does not stop the film. The next play tries again.
CHECK_TEST(test_plays_without_tactors)
{
  register_test_sink(GST_RANK_NONE);
  const std::string sink = kSink + "video-sink=visuotactiletestsink ";
  Player player(kFilm + sink + "device=/does/not/exist/amplitude.csv");
  change_state(player.pipeline, GST_STATE_PLAYING);
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

  // A board that fails during play: the simulator's file is on a full disk.
  g_object_set(player.chair, "device", "/dev/full", nullptr);
  change_state(player.pipeline, GST_STATE_PLAYING);
  player.wait_for_eos();
  ck_assert_int_eq(test_video_sink(shown_by(player.chair))->frames, 180);
  player.finish();
  ck_assert_uint_eq(player.warnings.size(), 2);
  player.trace();
}

/// A board fails, and the next play begins before the tactors are removed from the last one. They
/// stay in the pipeline.
CHECK_TEST(test_fails_late_in_the_last_play)
{
  register_test_sink(GST_RANK_NONE);
  Player player(kFilm + kSink + "video-sink=visuotactiletestsink");
  // Holds the thread that reports the error before the application gets the message.
  struct
  {
    std::atomic<bool> is_first{ true };
    std::promise<void> is_told;
    std::promise<void> may_go_on;
  } failure;
  gst_bus_set_sync_handler(
      player.bus,
      [](GstBus *, GstMessage *message, gpointer data) {
        auto *told = static_cast<decltype(failure) *>(data);
        if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING && told->is_first.exchange(false)) {
          told->is_told.set_value();
          told->may_go_on.get_future().wait();
        }
        return GST_BUS_PASS;
      },
      &failure, nullptr);
  change_state(player.pipeline, GST_STATE_PLAYING);
  std::atomic<int> removals{ 0 };
  g_signal_connect(player.pipeline, "deep-element-removed",
                   G_CALLBACK(+[](GstBin *, GstBin *, GstElement *, std::atomic<int> *removals) {
                     ++*removals;
                   }),
                   &removals);
  std::thread board([&player] {
    g_autoptr(GObject) tactors
        = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(player.chair), "tactors");
    GST_ELEMENT_ERROR(tactors, RESOURCE, WRITE, ("The test's board failed."), (nullptr));
  });
  failure.is_told.get_future().wait();
  change_state(player.pipeline, GST_STATE_READY);
  change_state(player.pipeline, GST_STATE_PLAYING);
  failure.may_go_on.set_value();
  board.join();
  player.wait_for_eos();
  ck_assert_int_eq(removals, 0);
  player.finish();
  ck_assert_uint_eq(player.warnings.size(), 1);
  fail_unless(commands_with_volts(player.trace()) > 0);
}

/// Frames that wait for motors are not available to the decoder, so more buffers are requested.
CHECK_TEST(test_asks_for_more_buffers)
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
  ck_assert_uint_ge(least, 11); // 190 ms are 9.5 frames at 50 fps, and one is shown
  gst_query_unref(query);
  gst_harness_teardown(harness);
}

/// Memory that only a device can read: the picture is shown, maps are silent, and there is one
/// warning.
CHECK_TEST(test_unreadable_memory)
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

/// Stepping through a paused film, over more frames than the queues hold, is not blocked by the
/// tactors.
CHECK_TEST(test_frames_are_stepped_through)
{
  Player player(kFilm + kSink + "video-sink=fakesink");
  change_state(player.pipeline, GST_STATE_PAUSED);
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

CHECK_MAIN(visuotactilesink_playing)
