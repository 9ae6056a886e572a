// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactiledecoder in pipelines of its own and fed by hand: which decoder it takes, when each
// frame is felt, what it tells. No test depends on the machine's speed.
#include <mutex>
#include <string>
#include <thread>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include <gst/base/gstbasesink.h>
#include <gst/check/gstharness.h>

#include "support/check_tests.h"

namespace {

constexpr GstClockTime kMs = GST_MSECOND;

void
rank_decoder(const char *name, guint rank)
{
  g_autoptr(GstPluginFeature) feature = gst_registry_lookup_feature(gst_registry_get(), name);
  fail_unless(feature != nullptr, "no %s", name);
  gst_plugin_feature_set_rank(feature, rank);
}

/// A decoder that is fed by hand.
GstHarness *
make_harness()
{
  GstHarness *harness = gst_harness_new("visuotactiledecoder");
  gst_child_proxy_set(GST_CHILD_PROXY(harness->element), "tactors::driver", "simulator", nullptr);
  return harness;
}

bool
accepts(GstElement *decoder, const char *text)
{
  g_autoptr(GstPad) pad = gst_element_get_static_pad(decoder, "sink");
  g_autoptr(GstCaps) caps = gst_caps_from_string(text);
  return gst_pad_query_accept_caps(pad, caps);
}

/// Factories of the elements that the bin decodes with, one after the other.
std::string
decoded_by(GstElement *decoder)
{
  std::string names;
  GstIterator *children = gst_bin_iterate_recurse(GST_BIN(decoder));
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(children, &item) == GST_ITERATOR_OK) {
    GstElementFactory *factory = gst_element_get_factory(GST_ELEMENT(g_value_get_object(&item)));
    if (factory
        && gst_element_factory_list_is_type(factory, GST_ELEMENT_FACTORY_TYPE_PARSER
                                                         | GST_ELEMENT_FACTORY_TYPE_DECODER))
      names += std::string(" ") + GST_OBJECT_NAME(factory);
    g_value_reset(&item);
  }
  g_value_unset(&item);
  gst_iterator_free(children);
  return names;
}

} // namespace

CHECK_TEST(test_the_best_decoder)
{
  GstHarness *harness = make_harness();
  fail_unless(accepts(harness->element, "image/jpeg, width=160, height=120"));
  fail_unless(decoded_by(harness->element) == " jpegdec");
  gst_harness_teardown(harness);

  rank_decoder("jpegdec", GST_RANK_NONE);
  harness = make_harness();
  fail_unless(accepts(harness->element, "image/jpeg, parsed=true, width=160, height=120"));
  fail_unless(decoded_by(harness->element) == " avdec_mjpeg");
  gst_harness_teardown(harness);
  rank_decoder("jpegdec", GST_RANK_PRIMARY);
}

CHECK_TEST(test_only_a_stream_replaces_a_decoder)
{
  GstHarness *harness = make_harness();
  fail_unless(accepts(harness->element, "image/jpeg, width=160, height=120"));
  g_autoptr(GstElement) queue = gst_bin_get_by_name(GST_BIN(harness->element), "video-queue");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(queue, "sink");
  g_autoptr(GstPad) chosen = gst_pad_get_peer(pad);
  fail_unless(accepts(harness->element, "video/x-theora"));
  g_autoptr(GstPad) asked = gst_pad_get_peer(pad);
  fail_unless(asked == chosen);
  fail_if(accepts(harness->element, "video/x-wmv, wmvversion=99"));
  gst_harness_set_src_caps_str(harness, "video/x-theora");
  fail_unless(decoded_by(harness->element) == " theoradec");
  gst_harness_teardown(harness);
}

CHECK_TEST(test_two_threads_ask)
{
  for (int i = 0; i < 10; i++) {
    GstHarness *harness = make_harness();
    bool accepted[2] = {};
    {
      std::vector<std::jthread> threads;
      for (bool &answer : accepted)
        threads.emplace_back([&] { answer = accepts(harness->element, "image/jpeg"); });
    }
    fail_unless(accepted[0] && accepted[1]);
    fail_unless(decoded_by(harness->element) == " jpegdec");
    gst_harness_teardown(harness);
  }
}

/// A parser alone is no promise. Each decoder leaves the registry, and returns.
CHECK_TEST(test_what_nobody_decodes_behind_a_parser)
{
  g_autoptr(GstCaps) h264 = gst_caps_from_string("video/x-h264");
  GList *all = gst_element_factory_list_get_elements(
      GST_ELEMENT_FACTORY_TYPE_DECODER | GST_ELEMENT_FACTORY_TYPE_MEDIA_VIDEO, GST_RANK_MARGINAL);
  GList *gone = gst_element_factory_list_filter(all, h264, GST_PAD_SINK, FALSE);
  fail_unless(gone != nullptr);
  GstHarness *harness = make_harness();
  g_autoptr(GstPad) pad = gst_element_get_static_pad(harness->element, "sink");
  for (const bool decodable : { true, false, true }) {
    g_autoptr(GstCaps) caps = gst_pad_query_caps(pad, h264);
    ck_assert_int_eq(!gst_caps_is_empty(caps), decodable);
    for (GList *item = gone; item != nullptr; item = item->next) {
      auto *feature = GST_PLUGIN_FEATURE(item->data);
      if (decodable)
        gst_registry_remove_feature(gst_registry_get(), feature);
      else
        gst_registry_add_feature(gst_registry_get(), GST_PLUGIN_FEATURE(gst_object_ref(feature)));
    }
  }
  gst_harness_teardown(harness);
  gst_plugin_feature_list_free(gone);
  gst_plugin_feature_list_free(all);
}

CHECK_TEST(test_what_nobody_decodes)
{
  GstHarness *harness = make_harness();
  fail_if(accepts(harness->element, "video/x-none-such, width=160, height=120"));
  fail_if(accepts(harness->element, "video/x-wmv, wmvversion=99"));
  fail_unless(decoded_by(harness->element) == "");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(harness->element, "sink");
  g_autoptr(GstCaps) caps = gst_pad_query_caps(pad, nullptr);
  g_autoptr(GstCaps) jpeg = gst_caps_from_string("image/jpeg");
  g_autoptr(GstCaps) unknown = gst_caps_from_string("video/x-wmv, wmvversion=99");
  fail_unless(gst_caps_can_intersect(caps, jpeg));
  fail_if(gst_caps_can_intersect(caps, unknown));
  gst_harness_teardown(harness);
}

CHECK_TEST(test_a_stream_that_needs_a_parser)
{
  GstElement *pipeline = make_pipeline(
      "videotestsrc num-buffers=10 ! video/x-raw,width=160,height=120 ! x264enc tune=zerolatency ! "
      "video/x-h264,stream-format=byte-stream ! "
      "capssetter replace=true caps=video/x-h264,stream-format=byte-stream ! "
      "visuotactiledecoder name=decoder tactors::driver=simulator ! fakesink name=sink");
  g_autoptr(GstElement) decoder = gst_bin_get_by_name(GST_BIN(pipeline), "decoder");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  change_state(pipeline, GST_STATE_PAUSED);
  fail_unless(decoded_by(decoder).find("h264parse") != std::string::npos, "%s",
              decoded_by(decoder).c_str());
  play_to_the_end(pipeline);
}

/// Bases of the segments that the analysis gets.
struct Bases
{
  std::mutex mutex;
  std::vector<GstClockTime> seen;

  static GstPadProbeReturn on_event(GstPad *, GstPadProbeInfo *info, gpointer user_data)
  {
    auto *self = static_cast<Bases *>(user_data);
    GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
    const GstSegment *segment = nullptr;
    if (GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT) {
      gst_event_parse_segment(event, &segment);
      std::lock_guard lock(self->mutex);
      self->seen.push_back(segment->base);
    }
    return GST_PAD_PROBE_OK;
  }
  GstClockTime wait_for(std::size_t count)
  {
    for (;;) {
      {
        std::lock_guard lock(mutex);
        if (seen.size() >= count)
          return seen.back();
      }
      g_usleep(1000);
    }
  }
};

void
begin_film(GstHarness *harness, guint group)
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  GstEvent *start = gst_event_new_stream_start("film");
  gst_event_set_group_id(start, group);
  gst_harness_push_event(harness, start);
  g_autoptr(GstCaps) caps = gst_caps_from_string("image/jpeg, width=64, height=48, framerate=10/1");
  gst_harness_push_event(harness, gst_event_new_caps(caps));
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
}

void
push_frames(GstHarness *harness, GstBuffer *jpeg, guint first, guint count)
{
  for (guint i = first; i < first + count; i++) {
    GstBuffer *frame = gst_buffer_copy(jpeg);
    GST_BUFFER_PTS(frame) = GST_BUFFER_DTS(frame) = i * 100 * kMs;
    GST_BUFFER_DURATION(frame) = 100 * kMs;
    ck_assert_int_eq(gst_harness_push(harness, frame), GST_FLOW_OK);
  }
}

void
send_qos(GstHarness *harness, GstClockTime shown, gint64 offset)
{
  GstEvent *qos = gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 1, 0, shown);
  gst_event_set_running_time_offset(qos, offset);
  gst_harness_push_upstream_event(harness, qos);
}

CHECK_TEST(test_films_one_after_the_other)
{
  GstHarness *encoder = gst_harness_new("jpegenc");
  gst_harness_set_src_caps_str(encoder,
                               "video/x-raw,format=I420,width=64,height=48,framerate=10/1");
  GstBuffer *raw = gst_buffer_new_allocate(nullptr, 64 * 48 * 3 / 2, nullptr);
  gst_buffer_memset(raw, 0, 90, 64 * 48 * 3 / 2);
  GST_BUFFER_PTS(raw) = 0;
  GstBuffer *jpeg = gst_harness_push_and_pull(encoder, raw);
  GstHarness *harness = make_harness();
  Bases bases;
  GObject *analysis
      = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(harness->element), "analysis");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(GST_ELEMENT(analysis), "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, Bases::on_event, &bases, nullptr);

  begin_film(harness, 1);
  push_frames(harness, jpeg, 0, 2);
  ck_assert_uint_eq(bases.wait_for(1), 0);
  begin_film(harness, 2); // after the first one, as it seems
  push_frames(harness, jpeg, 0, 2);
  ck_assert_uint_eq(bases.wait_for(2), 200 * kMs);
  send_qos(harness, 100 * kMs, 0);                               // no streamsynchronizer behind
  send_qos(harness, 900 * kMs, -5 * static_cast<gint64>(kMs));   // of a frame that has not come
  send_qos(harness, 310 * kMs, -210 * static_cast<gint64>(kMs)); // the sound is longer
  push_frames(harness, jpeg, 10, 1); // the decoder drops what QoS calls late
  ck_assert_uint_eq(bases.wait_for(3), 210 * kMs);
  gst_harness_push_event(harness, gst_event_new_flush_start());
  gst_harness_push_event(harness, gst_event_new_flush_stop(TRUE));
  begin_film(harness, 2);
  push_frames(harness, jpeg, 0, 1);
  ck_assert_uint_eq(bases.wait_for(4), 0);

  gst_buffer_unref(jpeg);
  g_object_unref(analysis);
  gst_harness_teardown(harness);
  gst_harness_teardown(encoder);
}

CHECK_TEST(test_another_size)
{
  GstElement *pipeline = make_pipeline(
      "concat name=c ! visuotactiledecoder name=decoder tactors::driver=simulator ! "
      "fakesink name=sink "
      "videotestsrc num-buffers=5 ! video/x-raw,width=160,height=120 ! jpegenc ! c. "
      "videotestsrc num-buffers=5 ! video/x-raw,width=64,height=48 ! jpegenc ! c.");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
  gint width = 0;
  gst_structure_get_int(gst_caps_get_structure(caps, 0), "width", &width);
  ck_assert_int_eq(width, 64);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

CHECK_LOOP_TEST(test_the_latency_of_a_live_source, 0, 2)
{
  const bool live = __i__ == 1;
  GstElement *pipeline = make_pipeline(
      std::string("tactiletestsrc is-live=") + (live ? "true" : "false")
      + " num-buffers=60 ! video/x-raw,width=64,height=48,framerate=30/1 ! jpegenc ! "
        "visuotactiledecoder name=decoder tactors::driver=simulator ! "
        "fakesink name=sink sync=true");
  g_autoptr(GstElement) decoder = gst_bin_get_by_name(GST_BIN(pipeline), "decoder");
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(decoder, "sink");
  g_autoptr(GstPad) src = gst_element_get_static_pad(decoder, "src");
  gst_element_set_state(pipeline, live ? GST_STATE_PLAYING : GST_STATE_PAUSED);
  gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
  g_autoptr(GstQuery) before = gst_query_new_latency();
  g_autoptr(GstQuery) behind = gst_query_new_latency();
  fail_unless(gst_pad_peer_query(pad, before) && gst_pad_query(src, behind));
  GstClockTime lead = 0;
  GstClockTime min_before = 0;
  GstClockTime min_behind = 0;
  gst_child_proxy_get(GST_CHILD_PROXY(decoder), "tactors::render-delay", &lead, nullptr);
  gst_query_parse_latency(before, nullptr, &min_before, nullptr);
  gst_query_parse_latency(behind, nullptr, &min_behind, nullptr);
  fail_unless(lead > 0);
  fail_unless(min_behind - min_before >= (live ? lead + 20 * kMs : 0));
  fail_unless(min_behind - min_before <= (live ? lead + 20 * kMs + 100 * kMs : 100 * kMs));
  if (live) { // the chair plays by the latency of the pipeline
    GObject *tactors = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(decoder), "tactors");
    gst_bin_recalculate_latency(GST_BIN(pipeline));
    fail_unless(gst_base_sink_get_latency(GST_BASE_SINK(sink)) >= lead);
    ck_assert_uint_eq(gst_base_sink_get_latency(GST_BASE_SINK(tactors)),
                      gst_base_sink_get_latency(GST_BASE_SINK(sink)));
    g_object_unref(tactors);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

GstPadProbeReturn
forget_time(GstPad *, GstPadProbeInfo *info, gpointer)
{
  GstBuffer *frame = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  info->data = frame;
  GST_BUFFER_PTS(frame) = GST_BUFFER_DTS(frame) = GST_BUFFER_DURATION(frame) = GST_CLOCK_TIME_NONE;
  return GST_PAD_PROBE_OK;
}

CHECK_TEST(test_frames_without_times_do_not_pile_up)
{
  GstElement *pipeline
      = make_pipeline("videotestsrc num-buffers=100 ! "
                      "video/x-raw,width=64,height=48,framerate=30/1 ! vp8enc deadline=1 ! "
                      "capssetter join=true caps=video/x-vp8,framerate=0/1 ! "
                      "visuotactiledecoder name=decoder tactors::driver=simulator ! fakesink");
  g_autoptr(GstElement) decoder = gst_bin_get_by_name(GST_BIN(pipeline), "decoder");
  g_autoptr(GstElement) queue = gst_bin_get_by_name(GST_BIN(pipeline), "video-queue");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(decoder, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, forget_time, nullptr, nullptr);
  gint full = 0;
  g_signal_connect(queue, "overrun",
                   G_CALLBACK(+[](GstElement *, gint *seen) { g_atomic_int_set(seen, 1); }), &full);
  change_state(pipeline, GST_STATE_PAUSED);
  guint waiting = 0;
  while (!g_atomic_int_get(&full)) {
    g_object_get(queue, "current-level-buffers", &waiting, nullptr);
    fail_unless(waiting <= 64, "%u frames", waiting);
    g_usleep(1000);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

CHECK_TEST(test_messages_of_the_chair)
{
  GstHarness *harness = make_harness();
  ElementBus bus(harness->element);
  GObject *tactors
      = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(harness->element), "tactors");
  GstObject *source = GST_OBJECT(tactors);
  gst_element_post_message(GST_ELEMENT(tactors),
                           gst_message_new_property_notify(source, "driver", nullptr));
  gst_element_post_message(GST_ELEMENT(tactors), gst_message_new_eos(source));
  fail_unless(bus.has(GST_MESSAGE_PROPERTY_NOTIFY));
  fail_if(bus.has(GST_MESSAGE_EOS));
  g_object_unref(tactors);
  gst_harness_teardown(harness);
}

CHECK_MAIN(visuotactiledecoder)
