// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's input: caps, maps and frames of all kinds, the drivers it opens, and its requests to
// upstream.
#include "support/tactorsink_rig.h"

#include "gst/fusion/sound_meta.h"

#include "support/contains.h"

#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include "support/check_tests.h"

CHECK_TEST(test_caps_change)
{
  SinkRig rig;
  rig.uncompensated();
  rig.play([&] {
    rig.push(0, { 1.0f });
    rig.change_grid(2, 2);
    rig.push(40 * kMs, { 0.0f, 0.5f, 0.0f, 1.0f });
  });
  const std::vector<Line> lines = rig.trace();
  std::map<int, std::vector<double>> volts;
  for (const Line &line : lines)
    volts[line.tactor].push_back(line.volts);
  fail_unless(volts[0] == (std::vector<double>{ 3.0, 0.0 }));
  fail_unless(volts[1] == (std::vector<double>{ 1.5, 0.0 }));
  fail_unless(volts[2].empty());
  fail_unless(volts[3] == (std::vector<double>{ 3.0, 0.0 }));
}

/// The grid changes while a level does not: the motor stays on, and the new cell's motor joins it.
CHECK_TEST(test_grid_change_keeps_steady_levels)
{
  SinkRig rig;
  rig.uncompensated();
  rig.play([&] {
    rig.push(0, { 1.0f });
    rig.change_grid(1, 2);
    for (GstClockTime pts = kFrame; pts < 400 * kMs; pts += kFrame)
      rig.push(pts, { 1.0f, 1.0f });
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], kFrame, kFrame, kFrame, 1, 3.0);
  assert_line(lines[2], 400 * kMs, 400 * kMs, 400 * kMs, 0, 0.0);
  assert_line(lines[3], 400 * kMs, 400 * kMs, 400 * kMs, 1, 0.0);
}

/// Maps of sound are taken at once, and leave the blocks of 200 ms as they are: a weaker picture
/// waits for the next block, one that is stronger than what is felt begins a block.
CHECK_TEST(test_sound_between_blocks)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "rate", 5.0, nullptr);
  const auto push = [&](GstClockTime pts, gfloat level, bool sounds) {
    GstBuffer *map = rig.buffer(pts, { level }, kFrame);
    if (sounds)
      GST_BUFFER_FLAG_SET(map, kSoundMap);
    ck_assert_int_eq(gst_pad_chain(rig.sink_pad, map), GST_FLOW_OK);
  };
  rig.play([&] {
    push(0, 0, false);
    push(kFrame, 1, true);
    push(2 * kFrame, 0.5F, false); // the block goes on
    push(3 * kFrame, 0, true);
    push(4 * kFrame, 0.5F, false); // the next block
    push(5 * kFrame, 0.6F, false);
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(kFrame, 40 * kMs);
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], kFrame, kFrame, kFrame, 0, 3.0);
  assert_line(lines[1], 3 * kFrame, 3 * kFrame, 3 * kFrame, 0, 0);
  assert_line(lines[2], 4 * kFrame, 4 * kFrame, 4 * kFrame, 0, 1.5);
}

/// A stream without times plays as it arrives.
CHECK_TEST(test_segment_in_bytes)
{
  SinkRig rig;
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_BYTES);
  rig.start(&segment);
  rig.run_to_end([&] { ck_assert_int_eq(rig.push(0, { 1.0f }), GST_FLOW_OK); });
  assert_silent_at_end(rig.trace());
}

/// A trace that cannot be written causes a warning at the end.
CHECK_TEST(test_full_disk_causes_a_warning)
{
  if (access("/dev/full", W_OK) != 0)
    return;
  SinkRig rig;
  g_object_set(rig.element, "trace-location", "/dev/full", "compensation", 2, nullptr);
  rig.play([&] { rig.push(0, { 1.0f }); });
  gst_element_set_state(rig.element, GST_STATE_READY);
  fail_unless(rig.messages.has(GST_MESSAGE_WARNING));
}

CHECK_TEST(test_video_frames_with_and_without_meta)
{
  SinkRig rig("video/x-raw,format=GRAY8,width=4,height=4,framerate=25/1");
  rig.uncompensated();
  rig.play([&] {
    for (int i = 0; i < 3; i++) {
      GstBuffer *frame = gst_buffer_new_allocate(nullptr, 16, nullptr);
      GST_BUFFER_PTS(frame) = static_cast<GstClockTime>(i) * 200 * kMs;
      GST_BUFFER_DURATION(frame) = kFrame;
      const gfloat levels[] = { 0.0f, 1.0f };
      if (i < 2)
        gst_buffer_add_tactile_meta(frame, 1, 2, levels, 2);
      ck_assert_int_eq(gst_pad_chain(rig.sink_pad, frame), GST_FLOW_OK);
    }
  });
  fail_unless(rig.messages.has(GST_MESSAGE_WARNING));
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[0], 0, 0, 0, 1, 3.0);
  assert_line(lines[1], 400 * kMs, 400 * kMs, 400 * kMs, 1, 0.0);
}

CHECK_TEST(test_missing_pts_follow_each_other)
{
  SinkRig rig;
  g_object_set(rig.element, "compensation", 2, "rate", 0.0, nullptr);
  rig.play([&] {
    rig.push(400 * kMs, { 1.0f });
    rig.push(GST_CLOCK_TIME_NONE, { 0.5f }, GST_CLOCK_TIME_NONE);
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 3);
  assert_line(lines[0], 400 * kMs, 400 * kMs, 400 * kMs, 0, 3.0);
  assert_line(lines[1], 440 * kMs, 440 * kMs, 440 * kMs, 0, 1.5);
  assert_line(lines[2], 480 * kMs, 480 * kMs, 480 * kMs, 0, 0.0);
}

/// Frames that have neither time stamps nor a rate are felt when they come, and a warning says so.
CHECK_TEST(test_frames_without_times)
{
  SinkRig rig("application/x-tactile-map,rows=1,columns=1,framerate=0/1");
  rig.uncompensated();
  const auto push = [&](GstClockTime running, gfloat level, guint64 issued) {
    gst_test_clock_set_time(rig.clock, kLatency + running);
    ck_assert_int_eq(rig.push(GST_CLOCK_TIME_NONE, { level }, GST_CLOCK_TIME_NONE), GST_FLOW_OK);
    while (rig.stat("issued") < issued)
      std::this_thread::yield();
  };
  rig.start();
  push(1000 * kMs, 0.0f, 0);
  push(1240 * kMs, 1.0f, 1);
  push(1480 * kMs, 0.5f, 2);
  push(1720 * kMs, 0.0f, 3);
  rig.rendered = true;
  rig.run_to_end([] {});
  fail_unless(rig.messages.has(GST_MESSAGE_WARNING));
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 3);
  assert_line(lines[0], 1240 * kMs, 1240 * kMs, 1240 * kMs, 0, 3.0);
  assert_line(lines[1], 1480 * kMs, 1480 * kMs, 1480 * kMs, 0, 1.5);
  assert_line(lines[2], 1720 * kMs, 1720 * kMs, 1720 * kMs, 0, 0);
}

/// One warning says that the times of maps do not advance.
CHECK_TEST(test_standing_times)
{
  SinkRig rig;
  g_object_set(rig.element, "sync", FALSE, nullptr);
  rig.start();
  for (int i = 0; i < 20; i++)
    ck_assert_int_eq(rig.push(0, { 1.0f }), GST_FLOW_OK);
  rig.end();
  const Said said = rig.messages.said(GST_MESSAGE_WARNING);
  fail_unless(said.text.find("do not advance") != std::string::npos, "%s", said.text.c_str());
  fail_if(rig.messages.has(GST_MESSAGE_WARNING));
}

/// Where nothing paces them, they follow each other.
CHECK_TEST(test_frames_without_times_or_clock)
{
  SinkRig rig("application/x-tactile-map,rows=1,columns=1,framerate=0/1");
  rig.uncompensated();
  g_object_set(rig.element, "sync", FALSE, "rate", 0.0, nullptr);
  rig.start();
  for (const gfloat level : { 0.0f, 1.0f, 0.5f, 0.0f })
    ck_assert_int_eq(rig.push(GST_CLOCK_TIME_NONE, { level }, GST_CLOCK_TIME_NONE), GST_FLOW_OK);
  rig.end();
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 3);
  for (std::size_t i = 0; i < lines.size(); i++)
    ck_assert_int_eq(lines[i].due, static_cast<gint64>(i + 1) * (GST_SECOND / 30));
}

/// A GAP that stands for lost packets does not end a cue, unlike one that stands for nothing.
CHECK_TEST(test_lost_data_are_no_gap)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "rate", 0.0, nullptr);
  const auto gap = [&](GstClockTime pts, GstGapFlags flags) {
    GstEvent *event = gst_event_new_gap(pts, kFrame);
    gst_event_set_gap_flags(event, flags);
    fail_unless(gst_pad_send_event(rig.sink_pad, event));
  };
  rig.play([&] {
    rig.push_level(0, 200 * kMs, 1);
    gap(200 * kMs, GST_GAP_FLAG_MISSING_DATA);
    rig.push_level(240 * kMs, 400 * kMs, 1);
    gap(400 * kMs, static_cast<GstGapFlags>(0));
    rig.push_level(440 * kMs, 600 * kMs, 1);
  });
  const std::vector<Line> lines = rig.trace();
  ck_assert_uint_eq(lines.size(), 4);
  assert_line(lines[0], 0, 0, 0, 0, 3.0);
  assert_line(lines[1], 400 * kMs, 400 * kMs, 400 * kMs, 0, 0);
  assert_line(lines[2], 440 * kMs, 440 * kMs, 440 * kMs, 0, 3.0);
  assert_line(lines[3], 600 * kMs, 600 * kMs, 600 * kMs, 0, 0);
}

/// The pad's offset puts a second of the stream before the pipeline's zero. What is felt then does
/// not put off what follows.
CHECK_TEST(test_negative_running_time)
{
  SinkRig rig;
  rig.uncompensated();
  g_object_set(rig.element, "rate", 0.0, nullptr);
  gst_pad_set_offset(rig.sink_pad, -static_cast<gint64>(GST_SECOND));
  rig.start();
  rig.push_level(0, 200 * kMs, 0); // these do not wait
  rig.push_level(200 * kMs, 400 * kMs, 1);
  rig.push_level(400 * kMs, 1000 * kMs, 0);
  rig.rendered = true;
  rig.run_to_end([&] {
    rig.push_level(1000 * kMs, 1400 * kMs, 0.5f);
    rig.push_level(1400 * kMs, 1600 * kMs, 0);
  });
  std::vector<Line> lines = rig.trace();
  std::erase_if(lines, [](const Line &line) { return line.effect < 0; });
  ck_assert_uint_eq(lines.size(), 2);
  assert_line(lines[0], 0, 0, 0, 0, 1.5);
  assert_line(lines[1], 400 * kMs, 400 * kMs, 400 * kMs, 0, 0);
}

CHECK_TEST(test_wrong_size_is_an_error)
{
  SinkRig rig;
  rig.start();
  GstFlowReturn flow = GST_FLOW_OK;
  rig.run_out([&] { flow = rig.push(0, { 1.0f, 1.0f }); });
  ck_assert_int_eq(flow, GST_FLOW_ERROR);
  fail_unless(rig.messages.has(GST_MESSAGE_ERROR));
}

CHECK_TEST(test_absurd_caps_are_refused)
{
  GstHarness *h = gst_harness_new_with_padnames("tactorsink", "sink", nullptr);
  GstPad *pad = gst_element_get_static_pad(h->element, "sink");
  GstCaps *caps = gst_caps_from_string(
      "application/x-tactile-map,rows=(int)65,columns=(int)3,framerate=(fraction)25/1");
  fail_if(gst_pad_query_accept_caps(pad, caps));
  gst_caps_unref(caps);
  caps = gst_caps_from_string("application/x-tactile-map,rows=(int)0,columns=(int)3");
  fail_if(gst_pad_query_accept_caps(pad, caps));
  gst_caps_unref(caps);
  gst_object_unref(pad);
  gst_harness_teardown(h);
}

/// tactor://SERIAL sets driver=firmata and device=SERIAL, with any serial number.
CHECK_TEST(test_uri)
{
  const std::pair<const char *, const char *> uris[] = {
    { "tactor://75833353035351F0C0A1", "75833353035351F0C0A1" },
    { "tactor://1-2.3", "1-2.3" },
    { "tactor://a%20b", "a b" },
    { "tactor://", nullptr },
  };
  for (const auto &[uri, device] : uris) {
    GstElement *sink = gst_element_make_from_uri(GST_URI_SINK, uri, nullptr, nullptr);
    fail_unless(sink != nullptr, "%s", uri);
    gst_object_ref_sink(sink);
    g_autofree gchar *driver = nullptr;
    g_autofree gchar *is_device = nullptr;
    g_object_get(sink, "driver", &driver, "device", &is_device, nullptr);
    ck_assert_str_eq(driver, "firmata");
    fail_unless(g_strcmp0(is_device, device) == 0, "%s", uri);
    g_autofree gchar *again = gst_uri_handler_get_uri(GST_URI_HANDLER(sink));
    ck_assert_str_eq(again, uri);

    // The simulator has no URI, and the URI cannot change while playing.
    g_object_set(sink, "driver", "simulator", "device", nullptr, nullptr);
    fail_unless(gst_uri_handler_get_uri(GST_URI_HANDLER(sink)) == nullptr);
    gst_element_set_state(sink, GST_STATE_PAUSED);
    GError *error = nullptr;
    fail_if(gst_uri_handler_set_uri(GST_URI_HANDLER(sink), "tactor://1-2", &error));
    fail_unless(g_error_matches(error, GST_URI_ERROR, GST_URI_ERROR_BAD_STATE));
    g_error_free(error);
    gst_element_set_state(sink, GST_STATE_NULL);
    gst_object_unref(sink);
  }
}

/// Errors name the requested value, and nothing plays.
static void
check_start_error(const char *property, const char *value, const char *expected)
{
  g_autoptr(GstElement) sink = make_tactorsink();
  const ElementBus messages(sink);
  g_object_set(sink, property, value, nullptr);
  gst_element_set_state(sink, GST_STATE_PAUSED);
  // Returns once opening the board has failed, or at once if it was not attempted.
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  fail_if(gst_pad_send_event(pad, gst_event_new_stream_start("film")));
  assert_contains(messages.said(GST_MESSAGE_ERROR).text, { expected });
  gst_element_set_state(sink, GST_STATE_NULL);
}

CHECK_TEST(test_start_errors)
{
  check_start_error("driver", "telepathy", "telepathy");
  check_start_error("driver", "telepathy", "simulator");
  check_start_error("trace-location", "/nonexistent/commands.csv", "/nonexistent/commands.csv");
  check_start_error("device", "amplitude.csv", "driver=simulator");
  check_start_error("mapping", "2;1;0", "'2;1;0'");
  check_start_error("mapping", "2;1;0", "as in 2,1,0");
}

CHECK_TEST(test_mapping_in_words)
{
  g_autoptr(GstElement) sink = make_tactorsink();
  const ElementBus messages(sink);
  const auto mapping = [&] {
    g_autofree gchar *text = nullptr;
    g_object_get(sink, "mapping", &text, nullptr);
    return std::string(text);
  };
  for (const char *text : { "0,-1,2", "<0,-1,2>", "< 0, -1, 2 >" }) {
    gst_util_set_object_arg(G_OBJECT(sink), "mapping", "");
    gst_util_set_object_arg(G_OBJECT(sink), "mapping", text); // as gst-launch-1.0 does
    assert_text(mapping(), "0,-1,2");
  }
  g_object_set(sink, "mapping", "0,4096,2", nullptr);
  assert_text(mapping(), "0,-1,2");
  assert_contains(messages.said(GST_MESSAGE_WARNING).text,
                  { "mapping stays", "number 2 is '4096'", "from 0 to 4095", "as in 2,1,0" });
}

/// Warnings that were logged.
static std::string warnings;

CHECK_TEST(test_refused_numbers_name_their_range)
{
  g_autoptr(GstElement) sink = make_tactorsink();
  const auto refused = [&](const char *property, const char *value) {
    warnings.clear();
    const auto fatal = g_log_set_always_fatal(G_LOG_LEVEL_ERROR);
    const GLogFunc before = g_log_set_default_handler(
        [](const gchar *, GLogLevelFlags, const gchar *text, gpointer) { warnings += text; },
        nullptr);
    _gst_check_expecting_log = TRUE; // GLib logs it
    gst_util_set_object_arg(G_OBJECT(sink), property, value);
    _gst_check_expecting_log = FALSE;
    g_log_set_default_handler(before, nullptr);
    g_log_set_always_fatal(fatal);
    return warnings;
  };
  assert_contains(refused("max-lead", "5000000000"),
                  { "max-lead", "5000000000", "range", "0 to 1000000000" });
  assert_contains(refused("voltage-max", "0.05"), { "voltage-max", "0.05", "0.1 to 24" });
  assert_text(refused("max-lead", "1000000000"), "");
  refused("max-lead", "1000000001");
  guint64 max_lead = 0;
  g_object_get(sink, "max-lead", &max_lead, nullptr);
  ck_assert_uint_eq(max_lead, GST_SECOND);
}

/// max-lead's default of 180 ms and a margin of 10 ms are 5.7 frames at 30 fps: 6, and the frame
/// that is shown.
CHECK_TEST(test_allocation_asks_for_lookahead)
{
  GstHarness *h = gst_harness_new_with_padnames("tactorsink", "sink", nullptr);
  GstCaps *caps = gst_caps_from_string("video/x-raw,format=I420,width=64,height=48,framerate=30/1");
  GstQuery *query = gst_query_new_allocation(caps, TRUE);
  GstPad *pad = gst_element_get_static_pad(h->element, "sink");
  fail_unless(gst_pad_query(pad, query));
  ck_assert_uint_eq(gst_query_get_n_allocation_pools(query), 1);
  guint min = 0;
  gst_query_parse_nth_allocation_pool(query, 0, nullptr, nullptr, &min, nullptr);
  ck_assert_uint_eq(min, 7);
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  gst_query_unref(query);
  gst_caps_unref(caps);
  gst_object_unref(pad);
  gst_harness_teardown(h);
}

/// All other sinks are delayed by this sink's render-delay.
CHECK_TEST(test_render_delay_is_the_lead)
{
  g_autoptr(GstElement) sink = make_tactorsink();
  g_object_set(sink, "max-lead", 80 * GST_MSECOND, nullptr);
  gst_element_set_state(sink, GST_STATE_PAUSED);
  guint64 delay = 0;
  g_object_get(sink, "render-delay", &delay, nullptr);
  ck_assert_uint_eq(delay, 90 * kMs);
  // Vibration before its frame is possible only if the frame waits.
  gst_element_set_state(sink, GST_STATE_NULL);
  g_object_set(sink, "delay", -200.0, "render-delay", guint64{ 0 }, nullptr);
  gst_element_set_state(sink, GST_STATE_PAUSED);
  g_object_get(sink, "render-delay", &delay, nullptr);
  ck_assert_uint_eq(delay, 290 * kMs);
  gboolean qos = TRUE;
  gboolean last_sample = TRUE;
  gint64 max_lateness = 0;
  g_object_get(sink, "qos", &qos, "enable-last-sample", &last_sample, "max-lateness", &max_lateness,
               nullptr);
  fail_if(qos);
  fail_if(last_sample);
  ck_assert_int_eq(max_lateness, -1);
  gst_element_set_state(sink, GST_STATE_NULL);
}

CHECK_MAIN(tactorsink_input)
