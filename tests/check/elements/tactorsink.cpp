// SPDX-License-Identifier: LGPL-2.1-or-later
//
// When tactorsink sends which commands: in play, pause, seek, mute and at the end. tactorsink_input
// tests its input.
#include "support/tactorsink_rig.h"

#include "support/contains.h"
#include <gst/base/gstbasesink.h>

#include "support/check_tests.h"

/// A rise from rest to full scale: 64.54 ms by Eq. 1. That is 1.6 frames of 40 ms, so two with
/// frame-block.
static void
check_compensation(const char *compensation, GstClockTime lead)
{
  SinkRig rig;
  gst_util_set_object_arg(G_OBJECT(rig.element), "compensation", compensation);
  rig.play([&] {
    for (GstClockTime pts = 0; pts <= 1000 * kMs; pts += kFrame)
      ck_assert_int_eq(rig.push(pts, { pts < 1000 * kMs ? 0.0f : 1.0f }), GST_FLOW_OK);
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  const GstClockTime due = 1000 * kMs - lead;
  assert_line(lines[0], due, due, 1000 * kMs, 0, 3.0);
  assert_line(lines[1], 1040 * kMs, 1040 * kMs, 1040 * kMs, 0, 0.0);
}

CHECK_TEST(test_compensation_exact)
{
  check_compensation("exact", rise(3.0));
}

CHECK_TEST(test_compensation_frame_block)
{
  check_compensation("frame-block", 2 * kFrame);
}

CHECK_TEST(test_compensation_none)
{
  check_compensation("none", 0);
}

/// Blocks at 5 Hz: within 200 ms only a level that is stronger by half changes anything. A block's
/// level is that of the map at its start.
CHECK_TEST(test_blocks_at_5_hz)
{
  SinkRig rig;
  rig.uncompensated();
  rig.play([&] {
    for (int i = 0; i < 20; i++) {
      const gfloat level = 0.2f * static_cast<gfloat>(i / 5 + 1);
      rig.push(static_cast<GstClockTime>(i) * kFrame, { i % 5 == 0 ? level : 1.4f * level });
    }
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 5);
  for (guint i = 0; i < 4; i++)
    assert_line(lines[i], i * 200 * kMs, i * 200 * kMs, i * 200 * kMs, 0, 0.6 * (i + 1));
  assert_line(lines[4], 800 * kMs, 800 * kMs, 800 * kMs, 0, 0);
}

/// A level that is stronger by half is felt at once, for a block, also if it lasts for one frame.
CHECK_TEST(test_stronger_at_once_at_5_hz)
{
  SinkRig rig;
  rig.uncompensated();
  rig.play([&] {
    for (int i = 0; i < 20; i++)
      rig.push(static_cast<GstClockTime>(i) * kFrame, { i == 7 ? 0.8f : 0.4f });
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 1.2);
  assert_line(lines[1], 7 * kFrame, 7 * kFrame, 7 * kFrame, 0, 2.4);
  assert_line(lines[2], 12 * kFrame, 12 * kFrame, 12 * kFrame, 0, 1.2);
  assert_line(lines[3], 20 * kFrame, 20 * kFrame, 20 * kFrame, 0, 0);
}

CHECK_TEST(test_pause_silences_and_resume_reissues)
{
  SinkRig rig;
  rig.uncompensated();
  rig.start();
  rig.stream([&] {
    rig.push(0, { 1.0f });
    rig.push(200 * kMs, { 1.0f });
    rig.push(400 * kMs, { 0.5f });
    rig.push(2000 * kMs, { 0.5f });
  });
  // Maps arrive at clock times 0, 200 and 400. The first level is due at 160, the latency.
  rig.run_to(300 * kMs);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  gst_test_clock_set_time(rig.clock, 1300 * kMs);
  gst_element_set_base_time(rig.element,
                            1000 * kMs); // as a pipeline does: running time stood still
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  rig.run_to(1600 * kMs);
  const std::vector<Line> lines = rig.trace();
  fail_unless(lines.size() >= 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 140 * kMs, 140 * kMs, 140 * kMs, 0, 0.0);
  assert_line(lines[2], 140 * kMs, 140 * kMs, 140 * kMs, 0, 3.0);
  assert_line(lines[3], 400 * kMs, 400 * kMs, 400 * kMs, 0, 1.5);
  assert_silent_at_end(lines);
}

/// Without another map the pause still completes. The next map resumes play.
CHECK_TEST(test_pause_waits_for_no_map)
{
  SinkRig rig;
  rig.start();
  g_object_set(rig.element, "async", TRUE, nullptr);
  rig.run_out([&] { rig.push(0, { 1.0f }); });
  ck_assert_int_eq(gst_element_set_state(rig.element, GST_STATE_PAUSED), GST_STATE_CHANGE_SUCCESS);
  ck_assert_int_eq(gst_element_set_state(rig.element, GST_STATE_PLAYING), GST_STATE_CHANGE_ASYNC);
  rig.run_out([&] { rig.push(400 * kMs, { 0.5f }); });
  ck_assert_int_eq(gst_element_get_state(rig.element, nullptr, nullptr, 0),
                   GST_STATE_CHANGE_SUCCESS);
  ck_assert_uint_eq(rig.stat("late"), 0);
  assert_silent_at_end(rig.trace());
}

/// A preroll may end after play was given up. The base class then signals it from the streaming
/// thread, after the pause.
CHECK_TEST(test_late_preroll_is_no_play)
{
  SinkRig rig;
  rig.start();
  rig.run_out([&] { rig.push(0, { 1.0f }); });
  gst_test_clock_set_time(rig.clock, 300 * kMs);
  while (rig.stat("issued") == 0)
    rig.wake_all_due();
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  GST_ELEMENT_GET_CLASS(rig.element)->change_state(rig.element, GST_STATE_CHANGE_PAUSED_TO_PLAYING);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  fail_unless(lines[0].volts > 0 && lines[1].volts == 0);
}

CHECK_TEST(test_flush_during_wait)
{
  SinkRig rig;
  rig.start();
  rig.stream([&] {
    rig.push(0, { 1.0f });
    rig.push(200 * kMs, { 0.0f });
    ck_assert_int_eq(rig.push(400 * kMs, { 1.0f }), GST_FLOW_FLUSHING);
  });
  rig.run_to(300 * kMs);
  fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_start()));
  rig.join();
  // The fall at 200 was planned but not due before clock time 360, so it is dropped. The motor
  // stops at once.
  ck_assert_uint_eq(rig.stat("dropped"), 1);
  fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_stop(TRUE)));
  gst_element_set_base_time(rig.element, 300 * kMs);
  rig.open();
  rig.rendered = false; // nothing more to wait for
  rig.run_to_end([&] { rig.push(0, { 0.5f }); });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  // No lead is possible at running time 0: the data would have been due 160 ms before the stream.
  fail_unless(lines[0].volts == 3.0);
  assert_line(lines[1], 140 * kMs, 140 * kMs, 140 * kMs, 0, 0.0);
  fail_unless(lines[2].volts == 1.5);
  ck_assert_int_eq(lines[2].effect, 0);
  assert_line(lines[3], kFrame, kFrame, kFrame, 0, 0);
}

CHECK_TEST(test_gap_is_zero_at_its_time)
{
  SinkRig rig;
  rig.uncompensated();
  rig.play([&] {
    rig.push(0, { 1.0f });
    // 120 ms is within the block: a gap does not wait for the block's end.
    fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_gap(120 * kMs, 40 * kMs)));
    rig.push(160 * kMs, { 0.5f });
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[1], 120 * kMs, 120 * kMs, 120 * kMs, 0, 0);
  assert_line(lines[2], 160 * kMs, 160 * kMs, 160 * kMs, 0, 1.5);
  assert_line(lines[3], 200 * kMs, 200 * kMs, 200 * kMs, 0, 0);
}

/// The EOS message follows the last frame's end and the motors' stop. It is not early by
/// render-delay.
CHECK_TEST(test_eos_drains)
{
  SinkRig rig;
  rig.play([&] {
    rig.push(0, { 0.0f });
    rig.push(200 * kMs, { 1.0f });
  });
  fail_unless(gst_clock_get_time(GST_CLOCK(rig.clock)) >= 240 * kMs + kLatency);
  bool eos = false;
  bool stats = false;
  while (GstMessage *message = gst_bus_pop(rig.messages.bus)) {
    eos |= GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    stats |= gst_message_has_name(message, "tactor-stats");
    gst_message_unref(message);
  }
  fail_unless(eos);
  fail_unless(stats);
  ck_assert_uint_eq(rig.stat("issued"), 2);
  ck_assert_uint_eq(rig.stat("dropped"), 0);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[0], 200 * kMs - rise(3.0), 200 * kMs - rise(3.0), 200 * kMs, 0, 3.0);
  assert_line(lines[1], 240 * kMs, 240 * kMs, 240 * kMs, 0, 0);
}

/// Effects are running times, at any rate and segment start.
static void
check_segment(gdouble rate, GstClockTime start, GstClockTime stop, GstClockTime pts,
              GstClockTime effect)
{
  SinkRig rig;
  rig.uncompensated();
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = rate;
  segment.start = start;
  segment.time = start;
  segment.stop = stop;
  segment.position = rate > 0 ? start : stop;
  rig.start(&segment);
  rig.run_to_end([&] { rig.push(pts, { 1.0f }); });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[0], effect, effect, effect, 0, 3.0);
  const GstClockTime end = effect + static_cast<GstClockTime>(kFrame / std::abs(rate));
  assert_line(lines[1], end, end, end, 0, 0);
}

CHECK_TEST(test_rates_and_segments)
{
  check_segment(1.0, 10 * GST_SECOND, GST_CLOCK_TIME_NONE, 10400 * kMs, 400 * kMs);
  check_segment(2.0, 0, GST_CLOCK_TIME_NONE, 1000 * kMs, 500 * kMs);
  check_segment(0.5, 0, GST_CLOCK_TIME_NONE, 200 * kMs, 400 * kMs);
  // Backwards, a frame is shown once its end is reached: at 2 s - (1.2 s + 40 ms).
  check_segment(-1.0, 0, 2 * GST_SECOND, 1200 * kMs, 760 * kMs);
}

/// After `later`, commands that already wait are due 500 ms later.
static void
check_moved_wait(const std::function<void(GstElement *)> &later)
{
  SinkRig rig;
  rig.uncompensated();
  rig.start();
  rig.stream([&] {
    rig.push(0, { 0.0f });
    rig.push(200 * kMs, { 1.0f });
    rig.push(600 * kMs, { 1.0f });
    rig.push(3000 * kMs, { 1.0f });
  });
  rig.run_to(250 * kMs);
  later(rig.element);
  rig.run_to(800 * kMs); // without the 500 ms, it would be issued at 360
  ck_assert_uint_eq(rig.stat("issued"), 0);
  rig.run_to(1000 * kMs);
  const std::vector<Line> lines = rig.trace();
  fail_unless(lines.size() >= 1);
  // Issued at clock time 860, which is 200 with the new latency: on time.
  assert_line(lines[0], 200 * kMs, 200 * kMs, 200 * kMs, 0, 3.0);
  assert_silent_at_end(lines);
}

CHECK_TEST(test_latency_change_moves_the_wait)
{
  check_moved_wait([](GstElement *element) {
    fail_unless(gst_element_send_event(element, gst_event_new_latency(kLatency + 500 * kMs)));
  });
}

/// playsink sets ts-offset whenever it builds its sinks anew.
CHECK_TEST(test_delay_moves_the_wait_and_is_not_ts_offset)
{
  check_moved_wait([](GstElement *element) {
    g_object_set(element, "delay", 500.0, nullptr);
    g_object_set(element, "ts-offset", gint64{ 0 }, nullptr);
  });
}

CHECK_TEST(test_mapping_and_volts)
{
  SinkRig rig("application/x-tactile-map,rows=1,columns=4,framerate=25/1");
  g_object_set(rig.element, "compensation", 2, "voltage-max", 2.0, "voltage-min", 0.6, "intensity",
               0.5, nullptr);
  gst_util_set_object_arg(G_OBJECT(rig.element), "mapping", "<3,-1,0,1>");
  rig.play([&] {
    // 1.0 V, ignored, 0.6 V (the minimum), 0.5 V (below it).
    rig.push(0, { 1.0f, 1.0f, 0.6f, 0.5f });
  });
  std::map<int, double> first;
  for (const Line &line : rig.trace())
    first.emplace(line.tactor, line.volts);
  ck_assert_uint_eq(first.size(), 2);
  fail_unless(std::abs(first[3] - (1.0)) <= 1e-3);
  fail_unless(std::abs(first[0] - (0.6)) <= 1e-3);
}

/// A mapping set while playing applies from the next map on.
CHECK_TEST(test_mapping_while_playing)
{
  SinkRig rig;
  rig.uncompensated();
  rig.play([&] {
    rig.push(0, { 1.0f });
    gst_util_set_object_arg(G_OBJECT(rig.element), "mapping", "<5>");
    rig.push(40 * kMs, { 1.0f });
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 40 * kMs, 40 * kMs, 40 * kMs, 0, 0.0);
  assert_line(lines[2], 40 * kMs, 40 * kMs, 40 * kMs, 5, 3.0);
  assert_line(lines[3], 80 * kMs, 80 * kMs, 80 * kMs, 5, 0.0);
}

/// So does an intensity of 0.
CHECK_LOOP_TEST(test_mute_acts_at_once, 0, 2)
{
  SinkRig rig;
  const bool mutes = __i__ == 0;
  const auto silence = [&](bool silent) {
    if (mutes)
      g_object_set(rig.element, "mute", silent, nullptr);
    else
      g_object_set(rig.element, "intensity", silent ? 0.0 : 1.0, nullptr);
  };
  rig.uncompensated();
  rig.start();
  rig.stream([&] {
    rig.push(0, { 1.0f });
    rig.push(400 * kMs, { 1.0f });
  });
  rig.run_to(250 * kMs);
  silence(true);
  gst_test_clock_set_time(rig.clock, 270 * kMs);
  silence(false);
  const std::vector<Line> lines = rig.trace();
  fail_unless(lines.size() >= 3);
  assert_line(lines[1], 90 * kMs, 90 * kMs, 90 * kMs, 0, 0.0);
  assert_line(lines[2], 110 * kMs, 110 * kMs, 110 * kMs, 0, 3.0);
  assert_silent_at_end(lines);
}

/// Volts and lead that the board and the pipeline already use do not change until the next play.
CHECK_TEST(test_volts_and_lead_are_fixed_while_playing)
{
  SinkRig rig;
  rig.play([&] {
    rig.push(0, { 0.0f });
    g_object_set(rig.element, "voltage-max", 24.0, "max-lead", GST_SECOND, nullptr);
    rig.push(400 * kMs, { 1.0f });
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[0], 400 * kMs - rise(3.0), 400 * kMs - rise(3.0), 400 * kMs, 0, 3.0);
}

/// Paused within the last frame: EOS waits for the resume, and the motor plays until the frame's
/// end.
CHECK_TEST(test_pause_in_the_last_frame)
{
  SinkRig rig;
  rig.uncompensated();
  rig.start();
  std::atomic<bool> done{ false };
  rig.stream([&] {
    rig.push(0, { 1.0f }, 2 * GST_SECOND);
    rig.end();
    done = true;
  });
  rig.run_to(1160 * kMs);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  gst_test_clock_set_time(rig.clock, 5160 * kMs);
  rig.wake_all_due();
  fail_if(done);
  gst_element_set_base_time(rig.element, 4000 * kMs);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  rig.wake_all_due();
  fail_if(done);
  gst_test_clock_set_time(rig.clock, 6160 * kMs); // running time 2 s
  while (!done)
    rig.wake_all_due();
  rig.join();
  ck_assert_uint_eq(rig.stat("dropped"), 0);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 1000 * kMs, 1000 * kMs, 1000 * kMs, 0, 0.0);
  assert_line(lines[2], 1000 * kMs, 1000 * kMs, 1000 * kMs, 0, 3.0);
  assert_line(lines[3], 2000 * kMs, 2000 * kMs, 2000 * kMs, 0, 0.0);
}

/// Without the clock no command is lost or coalesced, and each is traced as issued when due.
CHECK_TEST(test_sync_false_issues_every_command)
{
  SinkRig rig;
  g_object_set(rig.element, "sync", FALSE, "rate", 0.0, nullptr);
  rig.start();
  // The clock stands still.
  for (GstClockTime i = 0; i < 1000; i++)
    ck_assert_int_eq(rig.push(i * 200 * kMs, { i % 2 ? 1.0f : 0.0f }), GST_FLOW_OK);
  rig.end();
  ck_assert_uint_eq(rig.stat("issued"), 1000); // 500 rises, 499 falls, the end
  ck_assert_uint_eq(rig.stat("coalesced"), 0);
  ck_assert_uint_eq(rig.stat("dropped"), 0);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 1000);
  for (const Line &line : lines)
    ck_assert_int_eq(line.issued, line.due);
  assert_silent_at_end(lines);
}

/// Upstream stops delivering: motors hold the last map for its frame and a second, then stop. The
/// next map resumes play.
CHECK_TEST(test_starved)
{
  SinkRig rig;
  rig.uncompensated();
  rig.start();
  rig.stream([&] { rig.push(0, { 1.0f }); });
  rig.step(1); // the map arrives
  rig.join();
  rig.step(1); // its command is due
  ck_assert_uint_eq(rig.step(1), kLatency + kFrame + GST_SECOND);
  while (rig.stat("starved") == 0)
    std::this_thread::yield();
  rig.rendered = false; // nothing more to wait for
  rig.run_to_end([&] { rig.push(1600 * kMs, { 1.0f }); });
  ck_assert_uint_eq(rig.stat("starved"), 1);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[1], 1040 * kMs, 1040 * kMs, 1040 * kMs, 0, 0.0);
  assert_line(lines[2], 1600 * kMs, 1600 * kMs, 1600 * kMs, 0, 3.0);
}

/// Data too late for its lead takes effect at once and is counted. An element message reports it
/// once.
CHECK_TEST(test_late_is_counted_and_reported)
{
  SinkRig rig;
  rig.start();
  gst_test_clock_set_time(rig.clock, 1100 * kMs);
  rig.run_to_end([&] {
    rig.push(1000 * kMs, { 1.0f }); // due at 935.46 ms, issued at 940 ms
    rig.push(1200 * kMs, { 0.0f });
  });
  ck_assert_uint_eq(rig.stat("late"), 0); // 4.54 ms, within the tolerance of 5 ms
  SinkRig later;
  later.start();
  gst_test_clock_set_time(later.clock, 1150 * kMs);
  later.run_to_end([&] {
    later.push(1000 * kMs, { 1.0f }); // issued at 990 ms: 54.54 ms late
  });
  ck_assert_uint_eq(later.stat("late"), 1);
  ck_assert_uint_eq(later.stat("came-late"), 1);
  ck_assert_uint_eq(later.stat("thread-late"), 0);
  guint said = 0;
  while (GstMessage *message = gst_bus_pop_filtered(later.messages.bus, GST_MESSAGE_ELEMENT)) {
    if (gst_message_has_name(message, "tactor-lead-short")) {
      guint64 lead = 0;
      guint64 late = 0;
      const GstStructure *structure = gst_message_get_structure(message);
      fail_unless(gst_structure_get_uint64(structure, "lead", &lead));
      fail_unless(gst_structure_get_uint64(structure, "late", &late));
      ck_assert_uint_eq(lead, rise(3.0));
      ck_assert_uint_eq(late, 990 * kMs - (1000 * kMs - rise(3.0)));
      said++;
    }
    gst_message_unref(message);
  }
  ck_assert_uint_eq(said, 1);
}

/// What is posted as the stream goes on is posted without the preroll lock: a handler may pause the
/// pipeline.
CHECK_TEST(test_messages_without_the_preroll_lock)
{
  struct Told
  {
    std::string free;
    std::string locked;
  } told;
  const auto look = [](GstBus *, GstMessage *message, gpointer data) {
    if ((GST_MESSAGE_TYPE(message) & (GST_MESSAGE_ELEMENT | GST_MESSAGE_WARNING)) == 0)
      return GST_BUS_PASS;
    GMutex *lock = GST_BASE_SINK_GET_PREROLL_LOCK(GST_MESSAGE_SRC(message));
    const bool is_free = g_mutex_trylock(lock);
    if (is_free)
      g_mutex_unlock(lock);
    const GstStructure *structure = gst_message_get_structure(message);
    auto *told = static_cast<Told *>(data);
    (is_free ? told->free : told->locked) += std::string(gst_structure_get_name(structure)) + " ";
    return GST_BUS_PASS;
  };
  SinkRig rig("application/x-tactile-map,rows=1,columns=1,framerate=0/1");
  gst_bus_set_sync_handler(rig.messages.bus, look, &told, nullptr);
  rig.start();
  gst_test_clock_set_time(rig.clock, 1150 * kMs);
  rig.run_to_end([&] {
    rig.push(1000 * kMs, { 1.0f }); // late
    rig.push(1200 * kMs, { 0.5f });
    rig.push(GST_CLOCK_TIME_NONE, { 1.0f }, GST_CLOCK_TIME_NONE); // a warning
    rig.push(1400 * kMs, { 0.0f });
  });
  rig.finish();
  assert_text(told.locked, "");
  assert_text(told.free, "tactor-lead-short GstMessageWarning tactor-stats ");
}

/// The thread that issues commands is real-time where permitted, and reports its scheduling.
CHECK_TEST(test_realtime)
{
  g_setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent/bus", TRUE);
  g_unsetenv("DBUS_SESSION_BUS_ADDRESS");
  for (const bool wanted : { true, false }) {
    std::atomic<int> realtime{ -1 };
    const auto note = [](GstBus *, GstMessage *message, gpointer seen) {
      if (gst_message_has_name(message, "tactor-stats")) // it has issued commands, and goes on
        *static_cast<std::atomic<int> *>(seen) = realtime_threads();
      return GST_BUS_PASS;
    };
    SinkRig rig;
    if (!wanted)
      g_object_set(rig.element, "realtime", FALSE, nullptr);
    gst_bus_set_sync_handler(rig.messages.bus, note, &realtime, nullptr);
    rig.start();
    gst_test_clock_set_time(rig.clock, 1150 * kMs);
    rig.run_to_end([&] {
      rig.push(1000 * kMs, { 1.0f }); // 54.54 ms late
    });
    const bool expected = wanted && may_be_realtime();
    ck_assert_int_eq(realtime, expected ? 1 : 0);
    while (GstMessage *message = gst_bus_pop_filtered(rig.messages.bus, GST_MESSAGE_ELEMENT)) {
      if (gst_message_has_name(message, "tactor-stats"))
        ck_assert_str_eq(gst_structure_get_string(gst_message_get_structure(message), "scheduling"),
                         expected ? "direct" : "normal");
      gst_message_unref(message);
    }
    gst_bus_set_sync_handler(rig.messages.bus, nullptr, nullptr, nullptr);
  }
}

/// Three levels of one tactor wait. A lower latency makes all of them due, and only the last one is
/// sent.
CHECK_TEST(test_stale_commands_coalesce)
{
  SinkRig rig;
  g_object_set(rig.element, "compensation", 2, "rate", 0.0, nullptr);
  rig.start();
  rig.stream([&] {
    for (GstClockTime i = 0; i < 4; i++)
      rig.push(i * kFrame, { 0.25f * static_cast<gfloat>(i + 1) });
  });
  rig.run_to(115 * kMs); // maps came at 0, 40 and 80, due at 160, 200 and 240
  ck_assert_uint_eq(rig.stat("issued"), 0);
  fail_unless(gst_element_send_event(rig.element, gst_event_new_latency(0)));
  while (rig.stat("issued") == 0)
    std::this_thread::yield();
  ck_assert_uint_eq(rig.stat("issued"), 1);
  ck_assert_uint_eq(rig.stat("coalesced"), 2);
  const std::vector<Line> lines = rig.trace();
  assert_line(lines[0], 115 * kMs, 80 * kMs, 80 * kMs, 0, 2.25);
  assert_silent_at_end(lines);
}

/// Straight to NULL while playing: each motor's last command is zero.
CHECK_TEST(test_null_while_playing_is_silent)
{
  SinkRig rig("application/x-tactile-map,rows=3,columns=3,framerate=25/1");
  rig.uncompensated();
  rig.start();
  rig.stream([&] {
    rig.push(0, std::vector<gfloat>(9, 1.0f));
    rig.push(200 * kMs, std::vector<gfloat>(9, 1.0f));
    rig.push(400 * kMs, std::vector<gfloat>(9, 1.0f));
  });
  rig.run_to(300 * kMs);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 18);
  assert_silent_at_end(lines);
}

CHECK_MAIN(tactorsink)
