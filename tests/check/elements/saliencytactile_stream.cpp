// SPDX-License-Identifier: LGPL-2.1-or-later
//
// saliencytactile over time: properties that change, resets, rates, streams that begin anew, and what it tells of them.
#include "saliencytactile_rig.h"

/// A grid changed while playing holds from the next frame on; the other properties too.
GST_START_TEST(test_properties_while_playing)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 0, 0, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  guint i = 0;
  for (GstBuffer *frame : frames) {
    const guint rows = 1 + i % 7;
    const guint columns = 1 + (i * 5) % 64;
    g_object_set(h->element, "rows", rows, "columns", columns, "threshold", i / 16.0, "temporal",
                 i % 3 != 0, "floor", i % 5 - 1.0, "attach-saliency", i % 2 == 0, "max-rate",
                 i % 4 * 10.0, "profile", i % 2, "n-threads", i % 5, "exact", i % 7 < 3, nullptr);
    fail_unless_equals_int(gst_harness_push(h, gst_buffer_ref(frame)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    const GstTactileMeta *meta = gst_buffer_get_tactile_meta(out);
    ck_assert_uint_eq(meta->rows, rows);
    ck_assert_uint_eq(meta->columns, columns);
    ck_assert_int_eq(gst_buffer_get_saliency_meta(out) != nullptr, i % 2 == 0);
    gst_buffer_unref(out);
    i++;
  }
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Any number of threads feels the same, also when it changes while playing: the history goes on.
GST_START_TEST(test_threads)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("NV12", 1, 2, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "n-threads", 1, nullptr);
  const std::vector<gfloat> expected = play(h, caps, frames);
  gst_harness_teardown(h);
  ck_assert_uint_eq(strongest(expected), 5);

  h = gst_harness_new("saliencytactile");
  guint threads;
  g_object_get(h->element, "n-threads", &threads, nullptr);
  ck_assert_uint_eq(threads, 0);
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  for (GstBuffer *frame : frames) {
    g_object_set(h->element, "n-threads", ++threads, nullptr);
    fail_unless_equals_int(gst_harness_push(h, gst_buffer_ref(frame)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    if (frame == frames.back())
      fail_unless(levels_of(out) == expected);
    gst_buffer_unref(out);
  }
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// The floor silences whatever is weaker, whatever the frame's maximum.
GST_START_TEST(test_floor_silences)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 1, 1, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "floor", 500.0, nullptr);
  for (const gfloat level : play(h, caps, frames))
    fail_unless(level == 0);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Nothing bursts at the start, after a flush, a new segment, new caps or a discontinuity: the
/// square that is there at once is not an event.
GST_START_TEST(test_no_burst_after_resets)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 1, 1, &caps);
  GstBuffer *const empty = frames.front();
  GstBuffer *const square = frames.back();
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  GstClockTime pts = 0;
  const auto felt = [&](GstBuffer *frame, bool discont) {
    GstBuffer *copy = gst_buffer_copy(frame);
    GST_BUFFER_PTS(copy) = pts;
    pts += GST_SECOND / 30;
    if (discont)
      GST_BUFFER_FLAG_SET(copy, GST_BUFFER_FLAG_DISCONT);
    fail_unless_equals_int(gst_harness_push(h, copy), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    const std::vector<gfloat> levels = levels_of(out);
    gst_buffer_unref(out);
    return *std::ranges::max_element(levels) > 0;
  };
  fail_if(felt(square, false));
  for (int i = 0; i < 5; i++)
    fail_if(felt(empty, i == 0));
  fail_unless(felt(square, false), "the event itself must be felt");

  fail_if(felt(empty, true));
  fail_if(felt(square, true));
  fail_if(felt(empty, true));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  fail_if(felt(square, false));
  fail_if(felt(empty, true));
  fail_unless(gst_harness_push_event(h, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(h, gst_event_new_flush_stop(TRUE)));
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  fail_if(felt(square, false));
  pts = 0; // back in time without a word
  fail_if(felt(empty, false));
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Backwards, what appears is felt as forwards.
GST_START_TEST(test_reverse)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 0, 2, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  segment.position = GST_SECOND;
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  std::vector<gfloat> levels;
  for (std::size_t i = 0; i < frames.size(); i++) {
    GstBuffer *frame = gst_buffer_copy(frames[i]);
    GST_BUFFER_PTS(frame) = (frames.size() - 1 - i) * (GST_SECOND / 30);
    GST_BUFFER_FLAG_SET(frame, GST_BUFFER_FLAG_DISCONT); // as GstBaseSrc does
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    levels = levels_of(out);
    gst_buffer_unref(out);
  }
  ck_assert_uint_eq(strongest(levels), 2);
  fail_unless(std::ranges::max(levels) > 0);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Frames beyond max-rate repeat the map: at 30 frames/s and 10 analyses, two of three.
GST_START_TEST(test_max_rate)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 0, 0, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "max-rate", 10.0, nullptr);
  play(h, caps, frames);
  GstStructure *stats = nullptr;
  g_object_get(h->element, "stats", &stats, nullptr);
  guint64 passed = 0;
  guint64 analysed = 0;
  gst_structure_get_uint64(stats, "frames", &passed);
  gst_structure_get_uint64(stats, "analysed", &analysed);
  ck_assert_uint_eq(passed, 16);
  ck_assert_uint_eq(analysed, 6); // frames 0, 3, 6, 9, 12, 15
  gst_structure_free(stats);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// No rate is exceeded, whatever the film's: 25 of 30 frames a second.
GST_START_TEST(test_max_rate_is_not_exceeded)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "max-rate", 25.0, nullptr);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1");
  for (guint i = 0; i < 300; i++) {
    GstBuffer *frame = gst_harness_create_buffer(h, 256);
    gst_buffer_memset(frame, 0, 9, 256);
    GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
    GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    gst_buffer_unref(gst_harness_pull(h));
  }
  GstStructure *stats = nullptr;
  g_object_get(h->element, "stats", &stats, nullptr);
  guint64 analysed = 0;
  gst_structure_get_uint64(stats, "analysed", &analysed);
  fail_unless(analysed >= 249 && analysed <= 251, "%u", static_cast<guint>(analysed));
  gst_structure_free(stats);
  gst_harness_teardown(h);
}
GST_END_TEST;

/// With keep-maps a frame's own map stays, and is not paid for; without, it is replaced.
GST_START_TEST(test_keep_maps)
{
  for (const bool keep : { false, true }) {
    GstHarness *h = gst_harness_new("saliencytactile");
    g_object_set(h->element, "keep-maps", gboolean{ keep }, nullptr);
    gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1");
    for (guint i = 0; i < 4; i++) {
      GstBuffer *frame = gst_harness_create_buffer(h, 256);
      gst_buffer_memset(frame, 0, 9, 256);
      GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
      const gfloat own[] = { 0.5F, 0.25F };
      if (i % 2 == 1)
        gst_buffer_add_tactile_meta(frame, 1, 2, own, 2);
      fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
      GstBuffer *out = gst_harness_pull(h);
      fail_unless_equals_int(levels_of(out).size(), keep && i % 2 == 1 ? 2 : 9);
      fail_unless(levels_of(out)[0] == (keep && i % 2 == 1 ? 0.5F : 0.0F));
      gst_buffer_unref(out);
    }
    GstStructure *stats = nullptr;
    g_object_get(h->element, "stats", &stats, nullptr);
    guint64 frames = 0;
    guint64 analysed = 0;
    guint64 active = 0;
    gst_structure_get(stats, "frames", G_TYPE_UINT64, &frames, "analysed", G_TYPE_UINT64, &analysed,
                      "active", G_TYPE_UINT64, &active, nullptr);
    fail_unless_equals_uint64(frames, 4);
    fail_unless_equals_uint64(analysed, keep ? 2 : 4);
    fail_unless_equals_uint64(active, keep ? 2 : 0);
    gst_structure_free(stats);
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

GST_START_TEST(test_caps_change_mid_stream)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  for (const char *format : { "I420", "RGB", "GRAY8", "I420" })
    for (const int width : { 64, 33 }) {
      g_autofree gchar *caps = g_strdup_printf(
          "video/x-raw,format=%s,width=%d,height=31,framerate=25/1", format, width);
      gst_harness_set_src_caps_str(h, caps);
      GstVideoInfo info;
      GstCaps *parsed = gst_caps_from_string(caps);
      gst_video_info_from_caps(&info, parsed);
      gst_caps_unref(parsed);
      for (int i = 0; i < 3; i++) {
        GstBuffer *frame = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
        gst_buffer_memset(frame, 0, 100, gst_buffer_get_size(frame));
        fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
        GstBuffer *out = gst_harness_pull(h);
        for (const gfloat level : levels_of(out))
          fail_unless(level == 0);
        gst_buffer_unref(out);
      }
    }
  gst_harness_teardown(h);
}
GST_END_TEST;

GST_START_TEST(test_statistics_message_at_eos)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  GstBus *bus = gst_bus_new();
  gst_element_set_bus(h->element, bus);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=25/1");
  for (int i = 0; i < 3; i++) {
    GstBuffer *frame = gst_harness_create_buffer(h, 256);
    gst_buffer_memset(frame, 0, 9, 256);
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
  }
  fail_unless(gst_harness_push_event(h, gst_event_new_eos()));
  GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT);
  fail_unless(message && gst_message_has_name(message, "saliencytactile-stats"));
  guint64 frames = 0;
  gst_structure_get_uint64(gst_message_get_structure(message), "frames", &frames);
  ck_assert_uint_eq(frames, 3);
  gst_message_unref(message);
  gst_element_set_bus(h->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(h);
}
GST_END_TEST;

static Suite *
saliencytactile_stream_suite(void)
{
  Suite *suite = suite_create("saliencytactile_stream");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_test(cases, test_properties_while_playing);
  tcase_add_test(cases, test_threads);
  tcase_add_test(cases, test_floor_silences);
  tcase_add_test(cases, test_no_burst_after_resets);
  tcase_add_test(cases, test_reverse);
  tcase_add_test(cases, test_max_rate);
  tcase_add_test(cases, test_max_rate_is_not_exceeded);
  tcase_add_test(cases, test_keep_maps);
  tcase_add_test(cases, test_caps_change_mid_stream);
  tcase_add_test(cases, test_statistics_message_at_eos);
  return suite;
}

GST_CHECK_MAIN(saliencytactile_stream);
