// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What waits for the stream behind it: in order, by its length, bounded, and what a flush leaves.
#include "heldstream.h"

#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

namespace {

GstBuffer *
buffer_of(GstClockTime duration)
{
  GstBuffer *buffer = gst_buffer_new();
  GST_BUFFER_DURATION(buffer) = duration;
  return buffer;
}

/// Passes into a text: `b` for a buffer, else the event's name.
struct Passed
{
  std::string text{};
  HeldStream held{ { .pass =
                         [this](GstBuffer *buffer) {
                           text += "b ";
                           gst_buffer_unref(buffer);
                           return GST_FLOW_OK;
                         },
                     .pass_event = [this](GstEvent *event) -> gboolean {
                       text += GST_EVENT_TYPE_NAME(event) + std::string(" ");
                       gst_event_unref(event);
                       return TRUE;
                     } } };
};

GstEvent *
caps_event()
{
  g_autoptr(GstCaps) caps = gst_caps_new_empty_simple("audio/x-raw");
  return gst_event_new_caps(caps);
}

GstEvent *
segment_event()
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  return gst_event_new_segment(&segment);
}

} // namespace

CHECK_TEST(test_length)
{
  Passed passed;
  passed.held.hold(caps_event());
  ck_assert_str_eq(passed.text.c_str(), "caps ");
  passed.held.hold(buffer_of(10), 15);
  passed.held.hold(segment_event());
  passed.held.hold(buffer_of(10), 15);
  ck_assert_str_eq(passed.text.c_str(), "caps ");
  passed.held.hold(buffer_of(10), 15); // 20 follow the first, and the segment
  ck_assert_str_eq(passed.text.c_str(), "caps b segment ");
  passed.held.drain();
  ck_assert_str_eq(passed.text.c_str(), "caps b segment b b ");
}

/// The pad's peer has got none of what is held, and upstream does not send it again.
CHECK_TEST(test_a_flush_keeps_what_sticks)
{
  Passed passed;
  passed.held.hold(buffer_of(10), 100);
  passed.held.hold(gst_event_new_stream_start("next"));
  passed.held.hold(caps_event());
  passed.held.hold(segment_event());
  passed.held.hold(gst_event_new_gap(0, 10));
  passed.held.hold(gst_event_new_eos());
  ck_assert_str_eq(passed.text.c_str(), "");
  passed.held.flush();
  ck_assert_str_eq(passed.text.c_str(), "stream-start caps ");
  passed.held.hold(buffer_of(100), 100); // nothing else counts any more
  ck_assert_str_eq(passed.text.c_str(), "stream-start caps ");
}

CHECK_TEST(test_no_duration)
{
  Passed passed;
  passed.held.hold(buffer_of(10), 100);
  passed.held.hold(buffer_of(0), 100);
  ck_assert_str_eq(passed.text.c_str(), "b b ");
  passed.held.hold(buffer_of(GST_CLOCK_TIME_NONE), 100);
  ck_assert_str_eq(passed.text.c_str(), "b b b ");
}

CHECK_TEST(test_most_events)
{
  Passed passed;
  passed.held.hold(buffer_of(1), GST_SECOND);
  for (std::size_t i = 1; i < HeldStream::kMost; i++)
    passed.held.hold(gst_event_new_gap(0, 1));
  ck_assert_str_eq(passed.text.c_str(), "");
  passed.held.hold(segment_event());
  ck_assert_str_eq(passed.text.c_str(), "b ");
}

CHECK_TEST(test_most)
{
  Passed passed;
  for (std::size_t i = 0; i < HeldStream::kMost; i++)
    passed.held.hold(buffer_of(1), GST_SECOND);
  ck_assert_str_eq(passed.text.c_str(), "");
  passed.held.hold(buffer_of(1), GST_SECOND);
  ck_assert_uint_eq(passed.text.size(), 2 * (HeldStream::kMost + 1));
}

CHECK_MAIN(heldstream)
