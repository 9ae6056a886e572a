// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/check_tests.h"
#include <gst/check/gstharness.h>

#include <vector>

namespace {

/// The harness of a source that plays 1024 frames a buffer.
GstHarness *
source(const gchar *launch)
{
  GstHarness *harness = gst_harness_new_parse(launch);
  gst_harness_play(harness);
  return harness;
}

std::vector<float>
pulled(GstHarness *harness, GstClockTime *pts)
{
  GstBuffer *buffer = gst_harness_pull(harness);
  *pts = GST_BUFFER_PTS(buffer);
  std::vector<float> samples(gst_buffer_get_size(buffer) / sizeof(float));
  gst_buffer_extract(buffer, 0, samples.data(), samples.size() * sizeof(float));
  gst_buffer_unref(buffer);
  return samples;
}

} // namespace

// Time stamps follow each other, and each channel count has its samples.
CHECK_TEST(test_channels)
{
  for (const int channels : { 1, 2, 6, 8 }) {
    gchar *launch = g_strdup_printf(
        "tactilesoundtestsrc ! capsfilter caps=audio/x-raw,rate=32000,channels=%d", channels);
    GstHarness *harness = source(launch);
    g_free(launch);
    for (guint i = 0; i < 5; i++) {
      GstClockTime pts = 0;
      fail_unless_equals_int(pulled(harness, &pts).size(), 1024 * channels);
      fail_unless_equals_uint64(pts, i * 32 * GST_MSECOND);
    }
    gst_harness_teardown(harness);
  }
}

// After a seek the sound is as it would have been.
CHECK_TEST(test_seek)
{
  const gchar *launch = "tactilesoundtestsrc music=true ! capsfilter caps=audio/x-raw,rate=32000";
  GstHarness *harness = source(launch);
  std::vector<float> expected;
  GstClockTime pts = 0;
  while (pts < 64 * 32 * GST_MSECOND)
    expected = pulled(harness, &pts);
  gst_harness_teardown(harness);

  harness = gst_harness_new_parse(launch);
  GstElement *src = gst_harness_find_element(harness, "tactilesoundtestsrc");
  gst_element_set_state(harness->element, GST_STATE_READY);
  fail_unless(gst_element_send_event(
      src, gst_event_new_seek(1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, GST_SEEK_TYPE_SET,
                              64 * 32 * GST_MSECOND, GST_SEEK_TYPE_NONE, 0)));
  gst_harness_play(harness);
  fail_unless(pulled(harness, &pts) == expected);
  fail_unless_equals_uint64(pts, 64 * 32 * GST_MSECOND);
  gst_object_unref(src);
  gst_harness_teardown(harness);
}

// Each sound is told once, when it begins; before an impact there is silence.
CHECK_TEST(test_truth)
{
  GstElement *pipeline
      = gst_parse_launch("tactilesoundtestsrc num-buffers=300 name=s ! fakesink", nullptr);
  GstBus *bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  guint count = 0;
  guint64 last = 0;
  for (bool ended = false; !ended;) {
    GstMessage *message = gst_bus_timed_pop_filtered(
        bus, GST_CLOCK_TIME_NONE,
        static_cast<GstMessageType>(GST_MESSAGE_ELEMENT | GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    fail_unless(GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR);
    ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    if (!ended) {
      const GstStructure *truth = gst_message_get_structure(message);
      fail_unless_equals_string(gst_structure_get_string(truth, "kind"), "impact");
      guint64 begin = 0;
      fail_unless(gst_structure_get_uint64(truth, "begin", &begin));
      // 0.8 to 2 s after the last; the first after 1 to 2 s.
      fail_unless(begin - last >= 800 * GST_MSECOND && begin - last <= 2 * GST_SECOND);
      last = begin;
      count++;
    }
    gst_message_unref(message);
  }
  // 6.4 s.
  fail_unless(count >= 3 && count <= 7);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(pipeline);
}

CHECK_MAIN(tactilesoundtestsrc)
