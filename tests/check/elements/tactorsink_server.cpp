// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink on devices behind servers of the real protocols (support/haptic_server.py).
#include "support/haptic_server.h"
#include "support/playing.h"

#include <vector>

#include <gst/tactile/tactile.h>

namespace {

/// A sink that does not wait for the clock, and its server.
struct ServerRig
{
  ServerRig(const char *driver, const char *device, std::vector<std::string> arguments)
      : server(std::move(arguments))
  {
    const std::string name = server.device(device);
    g_object_set(element, "driver", driver, "device", name.c_str(), "sync", FALSE, "async", FALSE,
                 "rate", 0.0, "compensation", 2, "ramp-in", guint64{ 0 }, "max-active", 0, nullptr);
    sink_pad = gst_element_get_static_pad(element, "sink");
  }
  ~ServerRig()
  {
    gst_element_set_state(element, GST_STATE_NULL);
    gst_object_unref(sink_pad);
    gst_object_unref(element);
  }

  void start(guint rows, guint columns)
  {
    fail_if(gst_element_set_state(element, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_stream_start("film")));
    g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(rows, columns, 25, 1);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_caps(caps)));
    begin_segment();
  }
  void begin_segment()
  {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_segment(&segment)));
  }
  GstFlowReturn push(const std::vector<gfloat> &levels)
  {
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = frame++ * 40 * GST_MSECOND;
    GST_BUFFER_DURATION(map) = 40 * GST_MSECOND;
    return gst_pad_chain(sink_pad, map);
  }

  HapticServer server;
  GstElement *element
      = GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
  ElementBus messages{ element };
  GstPad *sink_pad = nullptr;
  guint frame = 0;
};

/// Each server, and what it prints when a map of 1 x 1 is 1.
struct Case
{
  const char *driver;
  const char *device;
  const char *kind;
  const char *full;
  const char *zero;
};

const std::vector<Case> kCases{
  { "bhaptics", "sleeve-left", "bhaptics", "motors ForearmL 0=100 1=100 2=100 3=100 4=100 5=100",
    "motors ForearmL" },
  { "intiface", "Test Vibrator", "buttplug3", "motors 0 0=1 2=1", "motors 0" },
  { "intiface", "Test Vibrator", "buttplug4", "motors 0 0=20 2=20", "motors 0" },
};

/// The next element message of this name. An error fails the test.
void
wait_for_message(const ServerRig &rig, const char *name)
{
  while (true) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        rig.messages.bus, GST_CLOCK_TIME_NONE,
        static_cast<GstMessageType>(GST_MESSAGE_ELEMENT | GST_MESSAGE_ERROR));
    ck_assert_int_eq(GST_MESSAGE_TYPE(message), GST_MESSAGE_ELEMENT);
    if (gst_message_has_name(message, name))
      return;
  }
}

} // namespace

/// The map's cells are felt where they are seen.
GST_START_TEST(test_places)
{
  ServerRig rig("bhaptics", "vest", { "bhaptics" });
  rig.start(5, 4);
  std::vector<gfloat> map(20);
  map[0] = map[19] = 1; // top left, bottom right
  ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
  rig.server.wait_for_line("motors VestBack 0=100 19=100");
  rig.server.wait_for_line("motors VestFront 0=100 19=100");
}
GST_END_TEST;

/// Several cells of a finer map share a motor, which is told once; a coarser one has several motors
/// a cell.
GST_START_TEST(test_grids)
{
  ServerRig rig("bhaptics", "vest-back", { "bhaptics" });
  rig.start(10, 8);
  std::vector<gfloat> map(80);
  map[8 + 1] = 0.5F; // one of the four cells of the first motor
  for (int i = 0; i < 2; i++)
    ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
  rig.server.wait_for_line("motors VestBack 0=50");
  int told = 0;
  while (g_autoptr(GstMessage) message = gst_bus_pop_filtered(rig.messages.bus, GST_MESSAGE_INFO))
    told += Said(message).text.find("share motors") != std::string::npos ? 1 : 0;
  ck_assert_int_eq(told, 1);

  ServerRig coarse("bhaptics", "visor", { "bhaptics" });
  coarse.start(2, 2);
  ck_assert_int_eq(coarse.push({ 0, 0, 0, 1 }), GST_FLOW_OK);
  coarse.server.wait_for_line("motors Head 3=100 4=100 5=100");
}
GST_END_TEST;

/// A mapping counts instead of the layout.
GST_START_TEST(test_mapping)
{
  ServerRig rig("intiface", "Test Vibrator", { "buttplug4" });
  g_object_set(rig.element, "mapping", "1,-1", nullptr);
  rig.start(1, 2);
  ck_assert_int_eq(rig.push({ 1, 1 }), GST_FLOW_OK);
  rig.server.wait_for_line("motors 0 2=20");
}
GST_END_TEST;

GST_START_TEST(test_zero_on_ways_out)
{
  for (const Case &one : kCases) {
    for (const GstState state : { GST_STATE_PAUSED, GST_STATE_READY, GST_STATE_NULL }) {
      ServerRig rig(one.driver, one.device, { one.kind });
      rig.start(1, 1);
      rig.push({ 1 });
      rig.server.wait_for_line(one.full);
      gst_element_set_state(rig.element, state);
      rig.server.wait_for_line(one.zero);
    }
    ServerRig rig(one.driver, one.device, { one.kind });
    rig.start(1, 1);
    rig.push({ 1 });
    rig.server.wait_for_line(one.full);
    // A seek, after which the film goes on.
    fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_start()));
    rig.server.wait_for_line(one.zero);
    fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_stop(TRUE)));
    rig.begin_segment();
    rig.frame = 0;
    rig.push({ 1 });
    rig.server.wait_for_line(one.full);
    // An error of the stream: a map of the wrong size. The application stops the play.
    ck_assert_int_eq(rig.push({ 1, 1 }), GST_FLOW_ERROR);
    gst_element_set_state(rig.element, GST_STATE_NULL);
    rig.server.wait_for_line(one.zero);
    ServerRig last(one.driver, one.device, { one.kind });
    last.start(1, 1);
    last.push({ 1 });
    last.server.wait_for_line(one.full);
    fail_unless(gst_pad_send_event(last.sink_pad, gst_event_new_eos()));
    last.server.wait_for_line(one.zero);
  }
}
GST_END_TEST;

/// The film goes on without its server.
GST_START_TEST(test_server_gone)
{
  for (const Case &one : kCases) {
    ServerRig rig(one.driver, one.device, { one.kind });
    rig.start(1, 1);
    rig.push({ 1 });
    rig.server.wait_for_line(one.full);
    rig.server.say("quit");
    wait_for_message(rig, "tactor-device-lost");
    ck_assert_int_eq(rig.push({ 0.5F }), GST_FLOW_OK);
  }
}
GST_END_TEST;

/// A server that floods, or sends 10 MB, is left in the middle of a film, which goes on. It is used
/// again.
GST_START_TEST(test_server_misbehaves)
{
  for (const char *deed : { "flood", "huge" })
    for (const Case &one : kCases) {
      ServerRig rig(one.driver, one.device, { one.kind });
      rig.start(1, 1);
      rig.push({ 1 });
      rig.server.wait_for_line(one.full);
      rig.server.say(deed);
      wait_for_message(rig, "tactor-device-lost");
      ck_assert_int_eq(rig.push({ 0 }), GST_FLOW_OK);
      wait_for_message(rig, "tactor-device-found");
      ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
      rig.server.wait_for_line(one.full);
    }
}
GST_END_TEST;

/// So is one that becomes silent.
GST_START_TEST(test_server_becomes_silent)
{
  for (const Case &one : kCases) {
    ServerRig rig(one.driver, one.device, { one.kind });
    rig.start(1, 1);
    rig.push({ 1 });
    rig.server.wait_for_line(one.full);
    rig.server.say("silent");
    ck_assert_int_eq(rig.push({ 0.5F }), GST_FLOW_OK);
    wait_for_message(rig, "tactor-device-lost");
    ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
  }
}
GST_END_TEST;

/// Of more cells than max-active the strongest are felt, each by all of its motors, and that is
/// told once.
GST_START_TEST(test_max_active)
{
  ServerRig rig("bhaptics", "vest-back", { "bhaptics" });
  g_object_set(rig.element, "max-active", 1, nullptr);
  rig.start(2, 2);
  for (int i = 0; i < 2; i++)
    ck_assert_int_eq(rig.push({ 0.5F, 1, 0.5F, 0.5F }), GST_FLOW_OK);
  rig.server.wait_for_line("motors VestBack 2=100 3=100 6=100 7=100 10=100 11=100");
  int told = 0;
  while (g_autoptr(GstMessage) message = gst_bus_pop_filtered(rig.messages.bus, GST_MESSAGE_INFO))
    told += Said(message).text.find("max-active") != std::string::npos ? 1 : 0;
  ck_assert_int_eq(told, 1);
}
GST_END_TEST;

static Suite *
tactorsink_server_suite(void)
{
  Suite *suite = suite_create("tactorsink_server");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_places);
  tcase_add_test(tests, test_grids);
  tcase_add_test(tests, test_mapping);
  tcase_add_test(tests, test_zero_on_ways_out);
  tcase_add_test(tests, test_server_gone);
  tcase_add_test(tests, test_server_misbehaves);
  tcase_add_test(tests, test_server_becomes_silent);
  tcase_add_test(tests, test_max_active);
  return suite;
}

GST_CHECK_MAIN(tactorsink_server);
