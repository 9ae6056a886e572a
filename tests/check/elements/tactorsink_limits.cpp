// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's properties that protect motors and skin, on the clock. libs/motor_limits tests the
// limits themselves.
#include "support/tactorsink_rig.h"

#include "support/check_tests.h"

CHECK_TEST(test_defaults_protect_motors)
{
  g_autoptr(GstElement) sink = make_tactorsink();
  guint64 max_on_time = 0;
  guint64 ramp_in = 0;
  gdouble max_duty = 0;
  guint max_active = 0;
  gboolean kick_start = TRUE;
  g_object_get(sink, "max-on-time", &max_on_time, "ramp-in", &ramp_in, "max-duty", &max_duty,
               "max-active", &max_active, "kick-start", &kick_start, nullptr);
  ck_assert_uint_eq(max_on_time, 2 * GST_SECOND);
  ck_assert_uint_eq(ramp_in, 100 * kMs);
  fail_unless(max_duty == 0.4);
  ck_assert_uint_eq(max_active, 4);
  fail_if(kick_start);
  // Sums with the longest times do not overflow.
  g_object_set(sink, "max-on-time", G_MAXUINT64, "ramp-in", G_MAXUINT64, "kick-start", TRUE,
               nullptr);
  g_object_get(sink, "max-on-time", &max_on_time, "kick-start", &kick_start, nullptr);
  ck_assert_uint_eq(max_on_time, 1000000000 * GST_SECOND);
  fail_unless(kick_start);
}

CHECK_TEST(test_max_on_time)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "max-on-time", guint64{ 500 * kMs }, nullptr);
  rig.play([&] {
    rig.push_level(0, 1200 * kMs, 1.0F);
    rig.push_level(1200 * kMs, 1400 * kMs, 0.0F);
    rig.push_level(1400 * kMs, 1600 * kMs, 0.5F);
  });
  ck_assert_uint_eq(rig.stat("cut-on-time"), 1);
  ck_assert_uint_eq(rig.stat("cut-duty"), 0);
  ck_assert_uint_eq(rig.stat("cut-active"), 0);
  ck_assert_uint_eq(rig.stat("issued"), 4);
  ck_assert_uint_eq(rig.stat("late"), 0);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 500 * kMs, 500 * kMs, 500 * kMs, 0, 0.0);
  assert_line(lines[2], 1400 * kMs, 1400 * kMs, 1400 * kMs, 0, 1.5);
  assert_line(lines[3], 1600 * kMs, 1600 * kMs, 1600 * kMs, 0, 0.0);
}

/// No more data, not even EOS: the motor stops on time nevertheless.
CHECK_TEST(test_max_on_time_without_another_map)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "max-on-time", guint64{ 500 * kMs }, nullptr);
  rig.start();
  rig.stream([&] { rig.push(0, { 1.0F }); });
  rig.step(1); // the map arrives
  rig.join();
  rig.step(1); // its command is due
  ck_assert_uint_eq(rig.step(1), kLatency + 500 * kMs);
  while (rig.stat("issued") < 2)
    std::this_thread::yield();
  ck_assert_uint_eq(rig.stat("starved"), 0);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[1], 500 * kMs, 500 * kMs, 500 * kMs, 0, 0.0);
}

/// A thread of the application has the element's lock, and gets no CPU time: motors stop in time.
CHECK_TEST(test_max_on_time_while_others_have_the_lock)
{
  SinkRig rig("application/x-tactile-map,rows=1,columns=2,framerate=25/1");
  rig.uncompensated();
  g_object_set(rig.element, "max-on-time", guint64{ 500 * kMs }, "rate", 0.0, nullptr);
  rig.start();
  rig.stream([&] {
    rig.push(0, { 1.0F, 0.0F });
    rig.push(200 * kMs, { 1.0F, 1.0F });
    rig.push(2000 * kMs, { 0.0F, 0.0F });
  });
  rig.run_to(600 * kMs);
  GST_OBJECT_LOCK(rig.element);
  ck_assert_uint_eq(rig.step(2), kLatency + 500 * kMs);
  // The first one's zero is written before the scheduler waits for the second one's.
  GList *pending = nullptr;
  gst_test_clock_wait_for_multiple_pending_ids(rig.clock, 2, &pending);
  g_list_free_full(pending, gst_clock_id_unref);
  ck_assert_uint_eq(gst_test_clock_get_next_entry_time(rig.clock), kLatency + 700 * kMs);
  GST_OBJECT_UNLOCK(rig.element);
  const std::vector<Line> lines = rig.trace();
  fail_unless(lines.size() >= 3);
  assert_line(lines[2], 500 * kMs, 500 * kMs, 500 * kMs, 0, 0.0);
}

/// Without the clock the film's time counts.
CHECK_TEST(test_max_on_time_without_the_clock)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "sync", FALSE, "max-on-time", guint64{ 500 * kMs }, nullptr);
  rig.start();
  rig.push_level(0, 1200 * kMs, 1.0F);
  rig.end();
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 500 * kMs, 500 * kMs, 500 * kMs, 0, 0.0);
}

/// EOS comes before another block could notice that the cue has run out.
CHECK_TEST(test_cue_runs_out_in_the_last_block)
{
  for (const bool sync : { true, false }) {
    SinkRig rig;
    rig.uncompensated();
    g_object_set(rig.element, "sync", gboolean{ sync }, "max-on-time", guint64{ 100 * kMs },
                 nullptr);
    rig.play([&] { rig.push_level(0, 160 * kMs, 1.0F); });
    ck_assert_uint_eq(rig.stat("cut-on-time"), 1);
    const std::vector<Line> lines = rig.trace();
    ck_assert_uint_eq(lines.size(), 2);
    assert_line(lines[1], 100 * kMs, 100 * kMs, 100 * kMs, 0, 0.0);
  }
}

/// 600 ms in any minute: time on before a seek counts after it.
CHECK_TEST(test_max_duty_outlives_a_seek)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "max-duty", 0.01, nullptr);
  rig.start();
  rig.stream([&] {
    rig.push_level(0, 400 * kMs, 1.0F);
    ck_assert_int_eq(rig.push(3000 * kMs, { 1.0F }), GST_FLOW_FLUSHING);
  });
  rig.run_to(kLatency + 350 * kMs);
  fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_start()));
  rig.join();
  fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_stop(TRUE)));
  gst_element_set_base_time(rig.element, kLatency + 350 * kMs);
  rig.open();
  rig.rendered = false; // nothing more to wait for
  rig.run_to_end([&] { rig.push_level(0, 1000 * kMs, 0.5F); });
  ck_assert_uint_eq(rig.stat("cut-duty"), 1);
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 350 * kMs, 350 * kMs, 350 * kMs, 0, 0.0);
  fail_unless(lines[2].volts == 1.5 && lines[2].effect == 0);
  assert_line(lines[3], 250 * kMs, 250 * kMs, 250 * kMs, 0, 0.0);
}

CHECK_TEST(test_max_active)
{
  SinkRig rig("application/x-tactile-map,rows=1,columns=3,framerate=25/1");
  rig.uncompensated();
  g_object_set(rig.element, "max-active", 2u, nullptr);
  rig.play([&] {
    rig.push(0, { 0.5F, 0.7F, 0.6F });
    rig.push(200 * kMs, { 1.0F, 0.7F, 0.6F });
    g_object_set(rig.element, "max-active", 0u, nullptr);
    rig.push(400 * kMs, { 1.0F, 0.7F, 0.6F });
  });
  ck_assert_uint_eq(rig.stat("cut-active"), 2);
  std::string told;
  for (const Line &line : rig.trace())
    told += std::to_string(line.due / static_cast<gint64>(kMs)) + ":" + std::to_string(line.tactor)
            + (line.volts > 0 ? "+ " : "- ");
  ck_assert_str_eq(told.c_str(), "0:1+ 0:2+ 200:0+ 200:2- 400:2+ 440:0- 440:1- 440:2- ");
}

/// After the start and after a pause, the first vibration rises in five steps.
CHECK_TEST(test_ramp_in)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "ramp-in", guint64{ 100 * kMs }, nullptr);
  rig.start();
  rig.stream([&] {
    rig.push_level(0, 400 * kMs, 1.0F);
    rig.push(2000 * kMs, { 1.0F });
  });
  rig.run_to(300 * kMs);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  gst_test_clock_set_time(rig.clock, 1300 * kMs);
  gst_element_set_base_time(rig.element, 1000 * kMs);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  rig.run_to(1500 * kMs);
  ck_assert_uint_eq(rig.stat("ramps"), 2);
  const std::vector<Line> lines = rig.trace();
  fail_unless(lines.size() >= 11);
  for (guint step = 0; step < 5; step++) {
    const GstClockTime ms = 20 * kMs * step;
    assert_line(lines[step], ms, ms, ms, 0, 0.6 * (step + 1));
    const GstClockTime again = 140 * kMs + ms;
    assert_line(lines[6 + step], again, again, again, 0, 0.6 * (step + 1));
  }
  assert_line(lines[5], 140 * kMs, 140 * kMs, 140 * kMs, 0, 0.0);
  assert_silent_at_end(lines);
}

/// 0.6 V from rest: full voltage for 64.54 ms · lg(3 / (3 - 0.9 · 0.6)) = 5.6 ms, but for at least
/// 10 ms.
CHECK_TEST(test_kick_start)
{
  SinkRig rig;
  g_object_set(rig.element, "kick-start", TRUE, nullptr);
  rig.play([&] {
    rig.push_level(0, 1000 * kMs, 0.0F);
    rig.push_level(1000 * kMs, 1200 * kMs, 0.2F);
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 3);
  assert_line(lines[0], 990 * kMs, 990 * kMs, 1000 * kMs, 0, 3.0);
  assert_line(lines[1], 1000 * kMs, 1000 * kMs, 1000 * kMs, 0, 0.6);
  assert_line(lines[2], 1200 * kMs, 1200 * kMs, 1200 * kMs, 0, 0.0);
}

/// The message that the latency has changed is posted while the board is being opened.
static GstBusSyncReply
mute_at_new_latency(GstBus *, GstMessage *message, gpointer muted)
{
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_LATENCY && !*static_cast<bool *>(muted)) {
    *static_cast<bool *>(muted) = true;
    g_object_set(GST_MESSAGE_SRC(message), "mute", TRUE, nullptr);
  }
  return GST_BUS_PASS;
}

/// Muted after the settings of the play were read: the motors stand still nevertheless.
CHECK_TEST(test_muted_while_opening)
{
  SinkRig rig;
  rig.uncompensated();
  bool muted = false;
  g_autoptr(GstBus) bus = gst_element_get_bus(rig.element);
  gst_bus_set_sync_handler(bus, mute_at_new_latency, &muted, nullptr);
  rig.play([&] { rig.push_level(0, 400 * kMs, 1.0F); });
  fail_unless(muted);
  ck_assert_uint_eq(rig.stat("issued"), 2);
  ck_assert_uint_eq(rig.trace().size(), 0); // nothing changed at the motor
}

CHECK_MAIN(tactorsink_limits)
