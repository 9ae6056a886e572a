// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Servers that flood, stall or lie: the film goes on, what happened is told, and neither memory nor
// time is theirs to take.
#include <sys/resource.h>

#include <memory>
#include <utility>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "server_rig.h"

#include "support/check_tests.h"

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMemoryIsOurs = false; // a sanitizer keeps what was freed
#else
constexpr bool kMemoryIsOurs = true;
#endif

/// Of this process, so far.
long
peak_kib()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

/// Plays on a server until it is left, and returns why. It may not cost much memory.
std::string
play_until_left(const Case &one, const char *behavior)
{
  ServerRig rig(one.driver, one.device, { one.kind, behavior, "gap=1" });
  rig.start(1, 1);
  const long before = peak_kib();
  std::string why = rig.play_until("tactor-device-lost");
  const long more = peak_kib() - before;
  fail_unless(more < 8 * 1024 || !kMemoryIsOurs, "%s of %s: %ld KiB", behavior, one.kind, more);
  ck_assert_uint_ge(rig.warnings, 1);
  rig.play_until("tactor-device-found");
  return why;
}

/// Waits for the error of a play that cannot begin.
Said
refusal_of(ServerRig &rig)
{
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  g_autoptr(GstMessage) message
      = gst_bus_timed_pop_filtered(rig.messages.bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_ERROR);
  return Said(message);
}

} // namespace

CHECK_TEST(test_flood)
{
  for (const Case &one : kCases) {
    // Which of the two bounds acts depends on how fast the server is.
    const std::string why = play_until_left(one, "flood=8");
    fail_unless(why.find("and more came") != std::string::npos
                    || why.find("it sends more than can be read") != std::string::npos,
                "%s", why.c_str());
  }
}

/// 10 MB of JSON in one message.
CHECK_TEST(test_huge)
{
  for (const Case &one : kCases)
    assert_contains(play_until_left(one, "huge=8"), { "larger than configured max-incoming" });
}

/// A server that answers nothing from the middle of the film on. All three at once, as it takes a
/// while.
CHECK_TEST(test_silent_during_play)
{
  std::vector<std::unique_ptr<ServerRig>> rigs;
  for (const Case &one : kCases) {
    rigs.push_back(std::make_unique<ServerRig>(one.driver, one.device,
                                               std::vector<std::string>{ one.kind, "gap=1" }));
    rigs.back()->start(1, 1);
    rigs.back()->push({ 1 });
    rigs.back()->server.wait_for_line(one.full);
    rigs.back()->server.say("silent=1");
  }
  for (const auto &rig : rigs)
    assert_contains(rig->play_until("tactor-device-lost"), { "none came for 5 s" });
}

/// Steps that no device has.
CHECK_TEST(test_lies_about_steps)
{
  for (const Case &one : kCases) {
    if (std::string(one.driver) != "intiface")
      continue;
    for (const char *steps : { "0", "-1", "100001", "99999999999999999999", "\"20\"", "[]" }) {
      ServerRig rig(one.driver, one.device, { one.kind, std::string("steps=") + steps });
      const Said said = refusal_of(rig);
      ck_assert_int_eq(said.code, GST_RESOURCE_ERROR_SETTINGS);
      assert_contains(said.text, { "to vibrate in 1 to 100000 steps" });
    }
  }
}

/// In a player the film is seen nevertheless.
CHECK_TEST(test_lies_in_a_player)
{
  HapticServer server({ "buttplug4", "steps=0" });
  GstElement *player = make_pipeline(
      "videotestsrc num-buffers=30 ! video/x-raw,width=64,height=48 ! visuotactilesink "
      "video-sink=fakesink driver=intiface device=\""
      + server.device("Test\\ Vibrator") + "\"");
  g_autoptr(GstBus) bus = gst_element_get_bus(player);
  gst_element_set_state(player, GST_STATE_PLAYING);
  bool is_told = false;
  for (bool ended = false; !ended;) {
    constexpr auto kTypes
        = static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING);
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, kTypes);
    ck_assert_int_ne(GST_MESSAGE_TYPE(message), GST_MESSAGE_ERROR);
    ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    if (!ended) {
      const Said said(message);
      is_told = is_told || (said.text + said.details).find("to vibrate in") != std::string::npos;
    }
  }
  fail_unless(is_told);
  gst_element_set_state(player, GST_STATE_NULL);
  gst_object_unref(player);
}

/// A device of 5000 motors has 64 for us.
CHECK_TEST(test_lies_about_counts)
{
  for (const Case &one : kCases) {
    if (std::string(one.driver) != "intiface")
      continue;
    ServerRig rig(one.driver, one.device, { one.kind, "motors=5000" });
    rig.start(1, 1);
    ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
    std::string full = "motors 0";
    for (int motor = 0; motor < 64; motor++)
      full += " " + std::to_string(motor) + (std::string(one.kind) == "buttplug4" ? "=20" : "=1");
    rig.server.wait_for_line(full);
    ck_assert_uint_eq(rig.infos(": 64 motors,"), 1);
  }
}

/// The device says something else in the middle of a film, as only version 4 can.
CHECK_TEST(test_changed_during_play)
{
  const Case &one = kCases.back();
  ServerRig rig(one.driver, one.device, { one.kind, "gap=1" });
  rig.start(1, 1);
  rig.push({ 1 });
  rig.server.wait_for_line(one.full);
  rig.server.say("steps=5");
  rig.server.say("add"); // the list is told to all
  assert_contains(rig.play_until("tactor-device-lost"), { "other motors than before" });
  rig.play_until("tactor-device-found");
  ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
  rig.server.wait_for_line("motors 0 0=5 2=5");
  // Another number of motors is another device.
  rig.server.say("motors=3");
  rig.server.say("add");
  rig.play_until("tactor-device-lost");
  assert_contains(rig.play_until("tactor-device-refused"),
                  { "expected 2 motors as before, found 3" });
}

CHECK_MAIN(tactorsink_bad_servers)
