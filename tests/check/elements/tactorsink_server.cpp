// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink on devices behind servers of the real protocols (support/haptic_server.py).
#include "tactor/command_trace.h"

#include <algorithm>
#include <map>
#include <tuple>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "server_rig.h"
#include "support/temporary_file.h"
#include "trace.h"

#include "support/check_tests.h"

/// The map's cells are felt where they are seen.
CHECK_TEST(test_places)
{
  ServerRig rig("bhaptics", "vest", { "bhaptics" });
  rig.start(5, 4);
  std::vector<gfloat> map(20);
  map[0] = map[19] = 1; // top left, bottom right
  ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
  rig.server.wait_for_line("motors VestBack 0=100 19=100");
  rig.server.wait_for_line("motors VestFront 0=100 19=100");
  ck_assert_uint_eq(rig.infos("share motors"), 0);
}

/// Several cells of a finer map share a motor, which is told once; a coarser one has several motors
/// a cell.
CHECK_TEST(test_grids)
{
  ServerRig rig("bhaptics", "vest-back", { "bhaptics" });
  rig.start(10, 8);
  std::vector<gfloat> map(80);
  map[8 + 1] = 0.5F; // one of the four cells of the first motor
  for (int i = 0; i < 2; i++)
    ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
  rig.server.wait_for_line("motors VestBack 0=50");
  ck_assert_uint_eq(rig.infos("share motors"), 1);

  // Also where a device is one row of motors.
  ServerRig row("intiface", "Test Vibrator", { "buttplug4" });
  row.start(3, 4);
  ck_assert_int_eq(row.push({ 0, 0, 0, 0, 0, 0, 0, 0.5F, 0.25F, 0, 0, 0 }), GST_FLOW_OK);
  row.server.wait_for_line("motors 0 0=5 2=10");
  ck_assert_uint_eq(row.infos("share motors"), 1);

  ServerRig coarse("bhaptics", "visor", { "bhaptics" });
  coarse.start(2, 2);
  ck_assert_int_eq(coarse.push({ 0, 0, 0, 1 }), GST_FLOW_OK);
  coarse.server.wait_for_line("motors Head 3=100 4=100 5=100");
}

/// max-active keeps the strongest cells, each with all of its motors. That is told once, and only
/// if it keeps any off.
CHECK_TEST(test_max_active)
{
  for (const auto &[device, max_active, front, back, told] :
       { std::tuple{ "vest", 2U, "motors VestFront 7=100 9=80", "motors VestBack 7=100 9=80", 1U },
         std::tuple{ "vest", 3U, "motors VestFront 7=100 8=60 9=80",
                     "motors VestBack 7=100 8=60 9=80", 0U } }) {
    ServerRig rig("bhaptics", device, { "bhaptics" });
    g_object_set(rig.element, "max-active", max_active, nullptr);
    rig.start(5, 4);
    std::vector<gfloat> map(20);
    map[7] = 1;
    map[8] = 0.6F;
    map[9] = 0.8F;
    for (int i = 0; i < 3; i++) {
      ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
      ck_assert_int_eq(rig.push(std::vector<gfloat>(20)), GST_FLOW_OK);
    }
    ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
    rig.server.wait_for_line(back);
    rig.server.wait_for_line(front);
    ck_assert_uint_eq(rig.infos("more would vibrate at once than max-active allows"), told);
  }
}

/// Back, front or both, by `device`.
CHECK_TEST(test_sides)
{
  for (const auto &[device, position] :
       { std::pair{ "", "VestBack" }, std::pair{ "vest-front", "VestFront" } }) {
    ServerRig rig("bhaptics", device, { "bhaptics" });
    rig.start(5, 4);
    std::vector<gfloat> map(20);
    map[4 * 2 + 3] = 1;
    ck_assert_int_eq(rig.push(map), GST_FLOW_OK);
    rig.server.wait_for_line(std::string("motors ") + position + " 11=100");
    const std::string other
        = std::string("motors ") + (position[4] == 'B' ? "VestFront" : "VestBack");
    ck_assert_uint_eq(rig.server.lines(other).size(), 0);
  }
}

/// A mapping counts instead of the layout.
CHECK_TEST(test_mapping)
{
  ServerRig rig("intiface", "Test Vibrator", { "buttplug4" });
  g_object_set(rig.element, "mapping", "1,-1", nullptr);
  rig.start(1, 2);
  ck_assert_int_eq(rig.push({ 1, 1 }), GST_FLOW_OK);
  rig.server.wait_for_line("motors 0 2=20");
}

CHECK_TEST(test_zero_on_ways_out)
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

/// Nothing that stops motors waits for a server that answers no more. Devices of Intiface are told
/// so by a zero: what stops them when the server is left, 5 s later, is another message.
CHECK_TEST(test_zero_waits_for_no_answer)
{
  const std::pair<const char *, void (*)(ServerRig &)> ways[] = {
    { "map",
      [](ServerRig &rig) {
        rig.push({ 0 });
      } },
    { "mute",
      [](ServerRig &rig) {
        g_object_set(rig.element, "mute", TRUE, nullptr);
      } },
    { "pause",
      [](ServerRig &rig) {
        gst_element_set_state(rig.element, GST_STATE_PAUSED);
      } },
    { "stop",
      [](ServerRig &rig) {
        gst_element_set_state(rig.element, GST_STATE_NULL);
      } },
    { "flush",
      [](ServerRig &rig) {
        fail_unless(gst_pad_send_event(rig.sink_pad, gst_event_new_flush_start()));
      } },
  };
  for (const Case &one : kCases)
    for (const auto &[name, stop] : ways) {
      if (&one != &kCases.back() && std::string(name) != "pause")
        continue; // each takes a while
      ServerRig rig(one.driver, one.device, { one.kind, "gap=1" });
      rig.start(1, 1);
      rig.push({ 1 });
      rig.server.wait_for_line(one.full);
      rig.server.say("speechless=1");
      rig.server.wait_for("set speechless");
      rig.push({ 0.5 });
      rig.server.wait_for("motors ");
      const auto stops = [&] {
        return rig.server.lines(R"(got [{"Stop)").size();
      };
      const std::size_t before = stops();
      stop(rig);
      rig.server.wait_for_line(one.zero);
      fail_unless(stops() == before || std::string(name) == "stop", "%s of %s", name, one.kind);
    }
}

/// The time that answers take is led by, also when it becomes longer during the play. There is room
/// for it from the beginning.
CHECK_TEST(test_latency)
{
  for (const Case &one : kCases) {
    const TemporaryFile trace;
    ServerRig rig(one.driver, one.device, { one.kind, "slow=40", "gap=1" });
    g_object_set(rig.element, "compensation", 0, "trace-location", trace.path.c_str(), nullptr);
    rig.start(1, 1);
    rig.play_until_latency(40, 119);
    rig.server.say("slow=120");
    rig.play_until_latency(120, 150);
    ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
    ck_assert_int_eq(rig.push({ 0 }), GST_FLOW_OK);
    fail_unless(rig.room() == std::chrono::milliseconds(150));
    gst_element_set_state(rig.element, GST_STATE_NULL);

    const std::vector<tactor::Time> leads = leads_of_zeros(trace.path);
    const auto has = [&](int least, int most) {
      return std::ranges::any_of(leads, [&](tactor::Time lead) {
        return lead >= std::chrono::milliseconds(least) && lead < std::chrono::milliseconds(most);
      });
    };
    fail_unless(has(40, 120) && has(120, 151));
    fail_unless(std::ranges::max(leads) <= std::chrono::milliseconds(150));
  }
}

/// The film goes on without its server, and is felt again when that is back.
CHECK_TEST(test_server_gone_and_back)
{
  for (const Case &one : kCases) {
    ServerRig rig(one.driver, one.device, { one.kind });
    rig.start(1, 1);
    rig.push({ 1 });
    rig.server.wait_for_line(one.full);
    rig.server.say("quit");
    assert_contains(rig.play_until("tactor-device-lost"), { "closed the connection" });
    HapticServer back({ one.kind, "port=" + rig.server.port() });
    rig.play_until("tactor-device-found");
    ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
    back.wait_for_line(one.full);
  }
}

CHECK_MAIN(tactorsink_server)
