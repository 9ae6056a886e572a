// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Frames whose times do not advance.
#include "film/frame_times.h"

#include <initializer_list>

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

namespace {

constexpr GstClockTime kNone = GST_CLOCK_TIME_NONE;

/// Times in ms.
struct Frame
{
  GstClockTime comes;
  GstClockTime duration;
  GstClockTime goes;
};

GstClockTime
ms(GstClockTime time)
{
  return time == kNone ? kNone : time * GST_MSECOND;
}

void
expect(GstHarness *harness, std::initializer_list<Frame> frames)
{
  for (const Frame &frame : frames) {
    GstBuffer *buffer = gst_harness_create_buffer(harness, 1);
    GST_BUFFER_PTS(buffer) = ms(frame.comes);
    GST_BUFFER_DURATION(buffer) = ms(frame.duration);
    GstBuffer *out = gst_harness_push_and_pull(harness, buffer);
    fail_unless_equals_clocktime(GST_BUFFER_PTS(out), ms(frame.goes));
    gst_buffer_unref(out);
  }
}

GstHarness *
harness_of(const gchar *caps)
{
  GstHarness *harness = gst_harness_new("identity");
  gst_harness_set_src_caps_str(harness, caps);
  GstPad *pad = gst_element_get_static_pad(harness->element, "sink");
  let_times_advance(pad);
  gst_object_unref(pad);
  return harness;
}

} // namespace

/// Of an animation, each frame with another duration, all at 0.
GST_START_TEST(test_all_at_zero)
{
  GstHarness *harness = harness_of("video/x-raw");
  expect(harness, { { 0, 100, 0 }, { 0, 30, 100 }, { 0, 500, 130 }, { 0, 100, 630 } });
  gst_harness_teardown(harness);
}
GST_END_TEST;

/// Frames without a time, by their duration or the frame rate; times that come count again.
GST_START_TEST(test_without_times)
{
  GstHarness *harness = harness_of("video/x-raw,framerate=25/1");
  expect(harness, { { 1000, kNone, 1000 },
                    { kNone, kNone, 1040 },
                    { kNone, 60, 1080 },
                    { 1160, kNone, 1160 },
                    { 1200, kNone, 1200 } });
  gst_harness_teardown(harness);
  // What nobody knows stays as it is.
  harness = harness_of("video/x-raw");
  expect(harness, { { kNone, kNone, kNone }, { 5, kNone, 5 }, { 5, kNone, 5 } });
  gst_harness_teardown(harness);
}
GST_END_TEST;

/// After a seek to the same frame it has its time again.
GST_START_TEST(test_seek)
{
  GstHarness *harness = harness_of("video/x-raw");
  expect(harness, { { 200, 40, 200 } });
  gst_harness_push_event(harness, gst_event_new_flush_start());
  gst_harness_push_event(harness, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
  expect(harness, { { 200, 40, 200 }, { 240, 40, 240 } });
  gst_harness_teardown(harness);
}
GST_END_TEST;

static Suite *
frame_times_suite()
{
  Suite *suite = suite_create("frame_times");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_test(cases, test_all_at_zero);
  tcase_add_test(cases, test_without_times);
  tcase_add_test(cases, test_seek);
  return suite;
}

GST_CHECK_MAIN(frame_times);
