// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>
#include <utility>

#include "support/synth_harness.h"

#include "support/check_tests.h"

CHECK_TEST(test_gaps)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.push(gst_event_new_gap(0, 200 * GST_MSECOND));
  fail_unless_equals_uint64(*synth.first, 0); // a sink prerolls
  synth.time = 200 * GST_MSECOND;
  synth.repeat({ 1 }, 5); // to 400 ms
  synth.push(gst_event_new_gap(synth.time, 200 * GST_MSECOND));
  synth.time += 200 * GST_MSECOND;
  synth.repeat({ 1 }, 5);          // 600 to 800 ms
  synth.time += 400 * GST_MSECOND; // no map, no gap: it holds
  synth.repeat({ 0.5F }, 5);       // 1200 to 1400 ms
  synth.time += 2 * GST_SECOND;    // too long
  synth.repeat({ 1 }, 5);          // from 3400 ms
  GstBuffer *silent = gst_buffer_new();
  GST_BUFFER_FLAG_SET(silent, GST_BUFFER_FLAG_GAP);
  GST_BUFFER_PTS(silent) = synth.time;
  GST_BUFFER_DURATION(silent) = kFrame;
  fail_unless_equals_int(gst_harness_push(synth.h, silent), GST_FLOW_OK);
  synth.end();
  const GstClockTime ms = GST_MSECOND;
  const std::pair<GstClockTime, GstClockTime> on[]
      = { { 200, 400 }, { 600, 1400 }, { 3400, 3600 } };
  for (const auto &[begin, end] : on) {
    fail_unless_within(synth.reaches(0.4F, (begin - 100) * ms), begin * ms, ms);
    fail_unless_within(synth.reaches(0.3F, begin * ms + 10 * ms, true), end * ms, 2 * ms);
  }
  fail_unless_near(synth.at(1100 * ms), 1, 1e-6);
  fail_unless_equals_float(synth.samples.back(), 0);
  ck_assert_int_eq(synth.discontinuities, 1);
}

CHECK_TEST(test_long_silence_is_a_gap)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 5);
  const std::size_t before = synth.samples.size();
  // Ten hours, and then thirty years, as a broken file may have.
  for (const GstClockTime later : { 36000 * GST_SECOND, 1000000000 * GST_SECOND }) {
    fail_unless_equals_int(synth.push({ 1 }, later), GST_FLOW_OK);
    fail_unless(synth.samples.size() < before + 2 * kRate);
    GstClockTime begin = 0;
    GstClockTime duration = 0;
    GstEvent *gap = synth.last_event(GST_EVENT_GAP);
    gst_event_parse_gap(gap, &begin, &duration);
    gst_event_unref(gap);
    fail_unless_within(begin + duration, later - kHalfRamp, GST_MSECOND);
    fail_unless(synth.next + kHalfRamp >= later);
  }
  ck_assert_int_eq(synth.discontinuities, 3);
  synth.push({ 1 }, 1000000000 * GST_SECOND + kFrame);
  fail_unless_near(synth.samples.back(), 1, 1e-6);
}

CHECK_TEST(test_flush)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 10);
  synth.seek(1, 10 * GST_SECOND, 20 * GST_SECOND);
  fail_unless_equals_int(synth.push({ 0 }, 10 * GST_SECOND), GST_FLOW_OK);
  fail_unless_equals_uint64(*synth.first, 0);
  for (const float sample : synth.samples)
    fail_unless_equals_float(sample, 0); // nothing of before
  fail_unless_equals_int(synth.push({ 1 }, 10 * GST_SECOND + 40 * GST_MSECOND), GST_FLOW_OK);
  fail_unless_equals_int(synth.push({ 1 }, 10 * GST_SECOND + 80 * GST_MSECOND), GST_FLOW_OK);
  fail_unless_within(synth.reaches(0.5F, 0), 40 * GST_MSECOND, GST_MSECOND);
  ck_assert_int_eq(synth.discontinuities, 2);
  const GstSegment *segment = nullptr;
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(synth.h->sinkpad, GST_EVENT_SEGMENT, 0);
  gst_event_parse_segment(event, &segment);
  fail_unless_equals_uint64(gst_segment_to_stream_time(segment, GST_FORMAT_TIME, GST_SECOND),
                            11 * GST_SECOND);
}

CHECK_TEST(test_rates)
{
  const Ones ones;
  for (const double rate : { 2.0, 0.5, -1.0, -2.0 }) {
    Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
    const GstClockTime stop = 12 * GST_SECOND;
    synth.seek(rate, 10 * GST_SECOND, stop);
    // In running time, the film's second half second vibrates.
    for (guint i = 0; i < 50; i++) {
      const GstClockTime pts = rate > 0 ? 10 * GST_SECOND + i * kFrame : stop - (i + 1) * kFrame;
      const bool on = i >= 25;
      fail_unless_equals_int(synth.push({ on ? 1.0F : 0.0F }, pts), GST_FLOW_OK);
    }
    const auto at = static_cast<GstClockTime>(GST_SECOND / std::abs(rate));
    fail_unless_within(synth.reaches(0.5F, 0), at, GST_MSECOND);
    // What a position query at an audio sink makes of a running time of 100 ms.
    const GstSegment *segment = nullptr;
    g_autoptr(GstEvent) event = gst_pad_get_sticky_event(synth.h->sinkpad, GST_EVENT_SEGMENT, 0);
    gst_event_parse_segment(event, &segment);
    fail_unless_equals_float(segment->rate, 1);
    const auto moved = static_cast<GstClockTime>(std::abs(rate) * 100 * GST_MSECOND);
    fail_unless_within(gst_segment_to_stream_time(segment, GST_FORMAT_TIME, 100 * GST_MSECOND),
                       rate > 0 ? 10 * GST_SECOND + moved : stop - moved,
                       rate > 0 ? 0 : 30 * GST_MSECOND);
  }
}

CHECK_TEST(test_segment_without_flush)
{
  // The second file of a playlist: running time goes on.
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 25);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.base = GST_SECOND;
  synth.push(gst_event_new_segment(&segment));
  for (guint i = 0; i < 25; i++)
    fail_unless_equals_int(synth.push({ i < 5 ? 0.0F : 1.0F }, i * kFrame), GST_FLOW_OK);
  synth.end();
  fail_unless_within(synth.reaches(0.5F, 500 * GST_MSECOND, true), GST_SECOND, GST_MSECOND);
  fail_unless_within(synth.reaches(0.5F, 1100 * GST_MSECOND), 1200 * GST_MSECOND, GST_MSECOND);
  ck_assert_int_eq(synth.discontinuities, 1);
  const GstSegment *sent = nullptr;
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(synth.h->sinkpad, GST_EVENT_SEGMENT, 0);
  gst_event_parse_segment(event, &sent);
  fail_unless_within(gst_segment_to_stream_time(sent, GST_FORMAT_TIME, 1500 * GST_MSECOND),
                     500 * GST_MSECOND, 10 * GST_MSECOND);
}

CHECK_TEST(test_clipped_by_the_segment)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.seek(1, 10 * GST_SECOND, 11 * GST_SECOND);
  fail_unless_equals_int(synth.push({ 1 }, 9 * GST_SECOND), GST_FLOW_OK);
  fail_unless(synth.samples.empty());
  fail_unless_equals_int(synth.push({ 1 }, 10 * GST_SECOND), GST_FLOW_OK);
  const std::size_t there = synth.samples.size();
  fail_unless(there > 0);
  fail_unless_equals_int(synth.push({ 1 }, 11 * GST_SECOND), GST_FLOW_OK);
  ck_assert_int_eq(synth.samples.size(), there);
}

/// The pad's offset puts a second of the stream before the pipeline's zero: it is not heard, and
/// does not put off what follows.
CHECK_TEST(test_negative_running_time)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  GstElement *element = gst_harness_find_element(synth.h, "tactilesynth");
  GstPad *pad = gst_element_get_static_pad(element, "sink");
  gst_pad_set_offset(pad, -static_cast<gint64>(GST_SECOND));
  gst_object_unref(pad);
  gst_object_unref(element);
  synth.repeat({ 0 }, 5);
  synth.repeat({ 1 }, 5); // to 400 ms
  synth.repeat({ 0 }, 15);
  synth.repeat({ 0.5F }, 10); // 1000 to 1400 ms
  synth.end();
  fail_unless_equals_uint64(*synth.first, 0);
  fail_unless_near(synth.at(200 * GST_MSECOND), 0.5, 0.01); // the kick decays
  fail_unless_within(synth.reaches(0.25F, 200 * GST_MSECOND, true), 400 * GST_MSECOND,
                     5 * GST_MSECOND);
}

CHECK_MAIN(tactilesynth_stream)
