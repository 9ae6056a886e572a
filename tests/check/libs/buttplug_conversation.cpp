// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Conversations with a Buttplug server, byte for byte, in times of their own. Expected messages are
// written by hand after the published specifications of versions 3 and 4.
#include "tactor/drivers/websocket/buttplug_conversation.h"

#include "support/contains.h"
#include "support/unwrap.h"

#include <cmath>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using State = Conversation::State;

namespace {

/// The examples of the specification.
const char *const kInfo4 = R"([{"ServerInfo":{"Id":1,"ServerName":"Test Server","MaxPingTime":0,)"
                           R"("ProtocolVersionMajor":4,"ProtocolVersionMinor":0}}])";
const char *const kList4 = R"([{"DeviceList":{"Id":2,"Devices":{
  "0":{"DeviceName":"Test Vibrator","DeviceIndex":0,"DeviceMessageTimingGap":0,
    "DeviceFeatures":{
      "0":{"FeatureIndex":0,"FeatureDescription":"a","Output":{"Vibrate":{"Value":[0,20]}}},
      "1":{"FeatureIndex":1,"FeatureDescription":"b","Output":{"Vibrate":{"Value":[0,10]}}},
      "3":{"FeatureIndex":3,"FeatureDescription":"Battery",
        "Input":{"Battery":{"Value":[[0,100]],"Command":["Read"]}}}}},
  "1":{"DeviceName":"Test Stroker","DeviceIndex":1,"DeviceMessageTimingGap":100,
    "DeviceDisplayName":"User set name","DeviceFeatures":{
      "0":{"FeatureIndex":0,"FeatureDescription":"Stroker","Output":{
        "HwPositionWithDuration":{"Value":[0,100],"Duration":[0,100000]},
        "Position":{"Value":[0,100]}}}}}}}}])";
/// In the place of the first device.
const char *const kAnother = R"([{"DeviceList":{"Id":0,"Devices":{
  "0":{"DeviceName":"Another","DeviceIndex":0,"DeviceFeatures":{
      "0":{"FeatureIndex":0,"FeatureDescription":"a","Output":{"Vibrate":{"Value":[0,20]}}}}}}}}])";
const char *const kInfo3
    = R"([{"ServerInfo":{"Id":1,"ServerName":"","MessageVersion":3,"MaxPingTime":100}}])";
const char *const kList3 = R"([{"DeviceList":{"Id":2,"Devices":[
  {"DeviceName":"Test Vibrator","DeviceIndex":0,"DeviceMessageTimingGap":100,
    "DeviceMessages":{"ScalarCmd":[
      {"StepCount":20,"FeatureDescriptor":"a","ActuatorType":"Vibrate"},
      {"StepCount":5,"FeatureDescriptor":"r","ActuatorType":"Rotate"},
      {"StepCount":20,"FeatureDescriptor":"b","ActuatorType":"Vibrate"}],"StopDeviceCmd":{}}},
  {"DeviceName":"Test Stroker","DeviceIndex":1,"DeviceDisplayName":"User set name",
    "DeviceMessages":{"LinearCmd":[
      {"StepCount":100,"FeatureDescriptor":"Stroker","ActuatorType":"Linear"}],
    "StopDeviceCmd":{}}}]}}])";

std::string
ok(int id)
{
  return R"([{"Ok":{"Id":)" + std::to_string(id) + "}}]";
}

std::string
error(int id)
{
  return R"([{"Error":{"Id":)" + std::to_string(id)
         + R"(,"ErrorMessage":"the device is busy","ErrorCode":4}}])";
}

struct Talk
{
  explicit Talk(const std::string &names = "Test Vibrator") : talk("Intiface", names)
  {
    talk.begin(now);
  }

  void expect(const std::string &text)
  {
    const std::optional<std::string> next = talk.next(now);
    fail_unless(next.has_value(), "no '%s'", text.c_str());
    assert_text(*next, text);
  }
  void expect_none()
  {
    const std::optional<std::string> next = talk.next(now);
    fail_if(next.has_value(), "%s", next ? next->c_str() : "");
  }
  void answer(const std::string &text)
  {
    talk.received(text, now);
  }
  void expect_failure(std::initializer_list<const char *> parts)
  {
    fail_unless(talk.state() == State::failed);
    assert_contains(talk.failure().text, parts);
  }
  /// From the beginning to playing, with version 4.
  void play(const std::string &info = kInfo4)
  {
    expect(R"([{"RequestServerInfo":{"Id":1,"ClientName":"visuotactile",)"
           R"("ProtocolVersionMajor":4,"ProtocolVersionMinor":0}}])");
    answer(info);
    expect(R"([{"RequestDeviceList":{"Id":2}}])");
    answer(kList4);
    expect(R"([{"StopCmd":{"Id":3,"DeviceIndex":0,"Inputs":false,"Outputs":true}}])");
    now += 7ms;
    answer(ok(3));
    fail_unless(talk.state() == State::playing, "%s", talk.failure().text.c_str());
    now += 1s;
  }

  Time now = 10s;
  ButtplugConversation talk;
};

} // namespace

CHECK_TEST(test_version_4)
{
  Talk talk;
  talk.play();
  const ServedDevice device = talk.talk.device();
  ck_assert_int_eq(device.tactors, 2);
  fail_unless(device.layout == (Layout{ 1, 2 }));
  fail_unless(device.motors
              == (std::vector<std::string>{ "Test Vibrator, motor 1", "Test Vibrator, motor 2" }));
  fail_unless(device.step == 0.1);
  fail_unless(talk.talk.latency() == 7ms && device.longest_latency == 150ms);
  fail_if(device.has_watchdog);
  assert_text(device.server, "Test Server, Buttplug 4");
  assert_contains(talk.talk.take_warnings().at(0), { "requires no pings" });
  talk.talk.set_levels(std::array{ 0.5, 1.0 });
  talk.expect(R"([{"OutputCmd":{"Id":4,"DeviceIndex":0,"FeatureIndex":0,)"
              R"("Command":{"Vibrate":{"Value":10}}}},)"
              R"({"OutputCmd":{"Id":5,"DeviceIndex":0,"FeatureIndex":1,)"
              R"("Command":{"Vibrate":{"Value":10}}}}])");
  talk.expect_none();
  talk.answer(ok(4));
  talk.talk.set_levels(std::array{ 0.25, 1.0 });
  talk.expect_none(); // the second answer is not there
  talk.answer(ok(5));
  talk.expect(R"([{"OutputCmd":{"Id":6,"DeviceIndex":0,"FeatureIndex":0,)"
              R"("Command":{"Vibrate":{"Value":5}}}}])");
  talk.answer(ok(6));
  talk.talk.set_levels(std::array{ 0.25, std::nan("") });
  talk.expect(R"([{"OutputCmd":{"Id":7,"DeviceIndex":0,"FeatureIndex":1,)"
              R"("Command":{"Vibrate":{"Value":0}}}}])");
}

/// A zero is sent at once, whatever is under way; other levels wait. Once all is answered it is
/// sent again, as the server may have carried out the level last.
CHECK_TEST(test_a_zero_waits_for_no_answer)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0, 1.0 });
  fail_unless(talk.talk.next(talk.now).has_value()); // 4 and 5
  talk.now += 1ms;
  talk.talk.set_levels(std::array{ 0.0, 0.5 });
  fail_unless(talk.talk.deadline() <= talk.now);
  talk.expect(R"([{"OutputCmd":{"Id":6,"DeviceIndex":0,"FeatureIndex":0,)"
              R"("Command":{"Vibrate":{"Value":0}}}}])");
  talk.expect_none();
  for (const int id : { 4, 6, 5 })
    talk.answer(ok(id));
  talk.expect(R"([{"OutputCmd":{"Id":7,"DeviceIndex":0,"FeatureIndex":0,)"
              R"("Command":{"Vibrate":{"Value":0}}}},)"
              R"({"OutputCmd":{"Id":8,"DeviceIndex":0,"FeatureIndex":1,)"
              R"("Command":{"Vibrate":{"Value":5}}}}])");
  talk.answer(ok(7));
  talk.answer(ok(8));
  talk.now += 1s;
  talk.expect_none();
}

/// Each motor's zero goes once to a server that never answers, which is left as soon as without.
CHECK_TEST(test_zeros_for_a_silent_server)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0, 1.0 });
  fail_unless(talk.talk.next(talk.now).has_value());
  const Time begun = talk.now;
  for (const double other : { 1.0, 0.0 }) {
    talk.now += 1s;
    talk.talk.set_levels(std::array{ 0.0, other });
    fail_unless(talk.talk.next(talk.now).has_value());
    for (const double again : { 0.3, 0.0 }) {
      talk.talk.set_levels(std::array{ again, other });
      talk.expect_none();
    }
  }
  fail_unless(talk.talk.deadline() == begun + 5s);
  talk.now = begun + 5s;
  talk.expect_none();
  talk.expect_failure({ "expected an answer" });
}

/// The gap is for the server to enforce, which sends the device the newest command after it.
CHECK_TEST(test_a_zero_waits_for_no_gap)
{
  Talk talk;
  talk.talk.hung_up("code 1002");
  talk.talk.begin(talk.now);
  talk.answer(kInfo3);
  talk.answer(kList3);
  while (talk.talk.next(talk.now))
    continue;
  talk.answer(ok(4));
  fail_unless(talk.talk.state() == State::playing);
  talk.now += 10ms;
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect_none(); // the gap is 100 ms
  talk.now += 90ms;
  while (const std::optional<std::string> text = talk.talk.next(talk.now))
    if (text->find("Ping") == std::string::npos)
      assert_contains(*text, { R"("Id":6)", R"("Scalar":1)" });
  talk.answer(ok(5));
  talk.answer(ok(6));
  talk.now += 10ms;
  talk.talk.set_levels({});
  talk.expect(R"([{"ScalarCmd":{"Id":7,"DeviceIndex":0,"Scalars":[)"
              R"({"Index":0,"Scalar":0,"ActuatorType":"Vibrate"}]}}])");
  talk.answer(ok(7));
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect_none();
}

/// A server of version 3 does not know the greeting of version 4: another connection has the older
/// one.
CHECK_TEST(test_version_3)
{
  Talk talk;
  fail_unless(talk.talk.next(talk.now).has_value());
  talk.answer(
      R"([{"Error":{"Id":0,"ErrorMessage":"missing field MessageVersion","ErrorCode":3}}])");
  fail_unless(talk.talk.state() == State::failed && talk.talk.tries_again());
  talk.talk.begin(talk.now);
  talk.expect(R"([{"RequestServerInfo":{"Id":2,"ClientName":"visuotactile","MessageVersion":3}}])");
  talk.answer(kInfo3);
  talk.expect(R"([{"RequestDeviceList":{"Id":3}}])");
  talk.answer(kList3);
  talk.expect(R"([{"StopDeviceCmd":{"Id":4,"DeviceIndex":0}}])");
  talk.answer(ok(4));
  fail_unless(talk.talk.state() == State::playing);
  fail_unless(talk.talk.device().has_watchdog);
  talk.now += 10ms;
  talk.talk.set_levels(std::array{ 0.5, 0.26 });
  fail_unless(talk.talk.deadline() == 10s + 50ms); // a ping is due before the gap is over
  talk.now = 10s + 50ms;
  talk.expect(R"([{"Ping":{"Id":5}}])");
  talk.answer(ok(5));
  talk.expect_none();
  talk.now = 10s + 100ms;
  talk.expect(R"([{"Ping":{"Id":6}}])");
  talk.expect(R"([{"ScalarCmd":{"Id":7,"DeviceIndex":0,"Scalars":[)"
              R"({"Index":0,"Scalar":0.5,"ActuatorType":"Vibrate"},)"
              R"({"Index":2,"Scalar":0.25,"ActuatorType":"Vibrate"}]}}])");
  talk.expect_none();
}

/// Neither version helps: the older one is not tried for ever.
CHECK_TEST(test_no_version)
{
  Talk talk;
  talk.talk.hung_up("code 1002");
  fail_unless(talk.talk.tries_again());
  talk.talk.begin(talk.now);
  talk.talk.hung_up("code 1002");
  fail_if(talk.talk.tries_again());
  talk.expect_failure({ "does not take this program", "code 1002" });
  Talk old;
  old.answer(R"([{"ServerInfo":{"Id":1,"ServerName":"","MessageVersion":2,"MaxPingTime":0}}])");
  old.expect_failure({ "expected version 3 or 4", "got 2" });
}

/// Nothing is started that was not named.
CHECK_TEST(test_names)
{
  for (const auto &[names, part] :
       { std::pair{ "", "as only named devices are used; it has 'Test Vibrator', 'User set name'" },
         std::pair{ "Vibrator", "'Vibrator', and it has 'Test Vibrator', 'User set name'" },
         std::pair{ "Test Vibrator,Test Vibrator", "a device 'Test Vibrator'" },
         std::pair{ "User set name", "expected 'User set name' to vibrate" },
         std::pair{ "Test Stroker", "expected 'Test Stroker' to vibrate" } }) {
    Talk talk(names);
    fail_unless(talk.talk.next(talk.now).has_value());
    talk.answer(kInfo4);
    fail_unless(talk.talk.next(talk.now).has_value());
    talk.answer(kList4);
    talk.expect_failure({ part });
    talk.talk.close(talk.now);
    talk.expect_none();
  }
  Talk none("Mine");
  none.answer(kInfo4);
  none.answer(R"([{"DeviceList":{"Id":2,"Devices":{}}}])");
  none.expect_failure({ "it has no devices", "scan" });
}

/// Steps that no device has are not believed.
CHECK_TEST(test_lies_about_steps)
{
  for (const char *steps :
       { "0", "-1", "100001", "99999999999999999999", "\"20\"", "null", "2.5" }) {
    const std::string list = R"([{"DeviceList":{"Id":2,"Devices":[{"DeviceName":"Test Vibrator",)"
                             R"("DeviceIndex":0,"DeviceMessages":{"ScalarCmd":[{"StepCount":)"
                             + std::string(steps) + R"(,"ActuatorType":"Vibrate"}]}}]}}])";
    Talk talk;
    talk.answer(kInfo4);
    talk.answer(list);
    talk.expect_failure({ "to vibrate in 1 to 100000 steps" });
  }
}

/// While a device has not answered, its next values wait; the newest ones win.
CHECK_TEST(test_one_message_under_way)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 0.1 });
  fail_unless(talk.talk.next(talk.now).has_value());
  for (const double level : { 0.2, 0.3, 0.4 }) {
    talk.now += 50ms;
    talk.talk.set_levels(std::array{ level });
    talk.expect_none();
  }
  talk.answer(ok(4));
  talk.expect(R"([{"OutputCmd":{"Id":5,"DeviceIndex":0,"FeatureIndex":0,)"
              R"("Command":{"Vibrate":{"Value":8}}}}])");
  // A level that is the same step is no news.
  talk.answer(ok(5));
  talk.now += 1s;
  talk.talk.set_levels(std::array{ 0.41 });
  talk.expect_none();
}

/// The latency is the median of the last nine answers: 1 ms, as often 40 ms, then 120 ms.
CHECK_TEST(test_latency)
{
  Talk talk;
  talk.play();
  int id = 4;
  const auto command = [&](Time takes, bool is_done = true) {
    talk.talk.set_levels(std::array{ id % 2 == 0 ? 1.0 : 0.5 });
    fail_unless(talk.talk.next(talk.now).has_value());
    talk.now += takes;
    talk.answer(is_done ? ok(id) : error(id));
    id++;
    talk.now += 100ms;
  };
  const auto expect = [&](Time latency) {
    fail_unless(talk.talk.latency() == latency, "%ld ns", long{ talk.talk.latency().count() });
  };
  for (int i = 0; i < 9; i++)
    command(40ms);
  expect(40ms);
  command(4s); // late, as 40 ms is what is usual
  command(1ms);
  expect(40ms);
  for (int i = 0; i < 4; i++)
    command(120ms);
  expect(120ms); // with the late one
  for (int i = 0; i < 20; i++)
    command(151ms);
  expect(150ms); // as planned for
  for (int i = 0; i < 5; i++)
    command(1ms);
  expect(1ms);
}

/// What was refused tells nothing.
CHECK_TEST(test_latency_of_errors)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0 });
  fail_unless(talk.talk.next(talk.now).has_value());
  talk.now += 90ms;
  talk.answer(error(4));
  fail_unless(talk.talk.latency() == 7ms);
}

/// Of two devices the slower one counts.
CHECK_TEST(test_latency_of_two)
{
  Talk talk("A,B");
  const auto vibrator = [](const char *name, int index) {
    const std::string number = std::to_string(index);
    return "\"" + number + R"(":{"DeviceName":")" + name + R"(","DeviceIndex":)" + number
           + R"(,"DeviceFeatures":{"0":{"FeatureIndex":0,"Output":{"Vibrate":{"Value":[0,20]}}}}})";
  };
  talk.answer(kInfo4);
  talk.answer(R"([{"DeviceList":{"Id":2,"Devices":{)" + vibrator("A", 0) + "," + vibrator("B", 1)
              + "}}}]");
  talk.now += 5ms;
  talk.answer(ok(3));
  fail_unless(talk.talk.state() == State::asking);
  talk.now += 25ms;
  talk.answer(ok(4));
  fail_unless(talk.talk.state() == State::playing, "%s", talk.talk.failure().text.c_str());
  fail_unless(talk.talk.latency() == 30ms);
}

CHECK_TEST(test_silent_server)
{
  Talk greeting;
  fail_unless(greeting.talk.next(greeting.now).has_value());
  fail_unless(greeting.talk.deadline() == greeting.now + 5s);
  greeting.now += 5s;
  greeting.expect_none();
  greeting.expect_failure({ "expected an answer", "5 s" });
  Talk talk;
  talk.play();
  talk.now += 1h;
  talk.talk.set_levels(std::array{ 1.0 });
  fail_unless(talk.talk.next(talk.now).has_value());
  talk.now += 5s;
  talk.expect_none();
  talk.expect_failure({ "expected an answer" });
}

CHECK_TEST(test_errors)
{
  Talk talk;
  talk.play();
  talk.talk.take_warnings();
  talk.talk.set_levels(std::array{ 1.0 });
  int id = 4;
  // It is told once, then again and again, both motors each time.
  for (int commands = 1; id < 4 + ButtplugConversation::kMostErrors; commands = 2) {
    fail_unless(talk.talk.next(talk.now).has_value());
    for (int i = 0; i < commands && id < 4 + ButtplugConversation::kMostErrors; i++) {
      fail_unless(talk.talk.state() == State::playing);
      talk.answer(error(id++));
    }
    talk.now += 1s;
  }
  talk.expect_failure({ "Test Vibrator", "the device is busy" });
  ck_assert_uint_eq(talk.talk.take_warnings().size(), 1);
}

/// A motor may be on.
CHECK_TEST(test_a_refused_zero_is_told_again)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0 });
  fail_unless(talk.talk.next(talk.now).has_value());
  talk.answer(ok(4));
  talk.now += 1s;
  talk.talk.set_levels(std::array{ 0.0 });
  const std::optional<std::string> zero = talk.talk.next(talk.now);
  assert_contains(zero.value(), { R"("Id":5)", R"("Value":0)" });
  talk.answer(error(5));
  const std::optional<std::string> again = talk.talk.next(talk.now);
  assert_contains(again.value(), { R"("Id":6)", R"("Value":0)" });
  talk.answer(ok(6));
  talk.answer(ok(7)); // its other motor
  talk.now += 1s;
  fail_if(talk.talk.next(talk.now).has_value());
}

CHECK_TEST(test_gone)
{
  for (const char *text : { R"([{"DeviceList":{"Id":0,"Devices":{}}}])", kAnother,
                            R"([{"DeviceRemoved":{"Id":0,"DeviceIndex":0}}])" }) {
    Talk talk;
    talk.play();
    talk.answer(R"([{"DeviceRemoved":{"Id":0,"DeviceIndex":7}}])");
    talk.answer(
        R"([{"DeviceAdded":{"Id":0,"DeviceName":"x","DeviceIndex":8,"DeviceMessages":{}}}])");
    fail_unless(talk.talk.state() == State::playing);
    talk.answer(text);
    talk.expect_failure({ "Test Vibrator", "switched off" });
    fail_unless(talk.talk.failure().kind == DriverError::Kind::lost);
  }
}

/// Also with a command under way, and after a failure.
CHECK_TEST(test_close)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0 });
  fail_unless(talk.talk.next(talk.now).has_value());
  talk.talk.close(talk.now);
  talk.expect(R"([{"StopCmd":{"Id":5,"DeviceIndex":0,"Inputs":false,"Outputs":true}}])");
  talk.answer(ok(4));
  fail_unless(talk.talk.state() == State::closing);
  talk.answer(ok(5));
  fail_unless(talk.talk.state() == State::closed);

  Talk silent;
  silent.play();
  silent.talk.hung_up("it hung up");
  silent.talk.close(silent.now);
  fail_unless(silent.talk.next(silent.now).has_value());
  fail_unless(silent.talk.deadline() == silent.now + 250ms);
  silent.now += 250ms;
  silent.expect_none();
  fail_unless(silent.talk.state() == State::closed);
}

/// A gap or a ping time that makes no sense is bounded.
CHECK_TEST(test_lies_about_times)
{
  Talk talk;
  talk.play(
      R"([{"ServerInfo":{"Id":1,"ServerName":"","MaxPingTime":1,"ProtocolVersionMajor":4}}])");
  fail_unless(talk.talk.next(talk.now).has_value());
  talk.answer(ok(4));
  fail_unless(talk.talk.deadline() == talk.now + 10ms);
  const auto messages
      = buttplug::read_messages(R"([{"DeviceList":{"Id":2,"Devices":[)"
                                R"({"DeviceIndex":0,"DeviceMessageTimingGap":4294967295}]}}])");
  fail_unless(std::get<buttplug::DeviceList>(messages->at(0)).devices.at(0).gap == Time(2s));
}

CHECK_TEST(test_other_messages)
{
  for (const char *text : { "", "{}", "null", "[", "{\"Ok\":{\"Id\":1}}" })
    fail_if(buttplug::read_messages(text).has_value(), "%s", text);
  for (const char *text : { "[]", "[1]", "[{}]", "[{\"Ok\":1}]", "[{\"Ok\":{\"Id\":-1}}]",
                            "[{\"Ok\":{\"Id\":\"1\"}}]", "[{\"ScanningFinished\":{\"Id\":0}}]",
                            "[{\"Ok\":{\"Id\":4294967296}}]", "[{\"DeviceRemoved\":{\"Id\":0}}]" })
    fail_unless(buttplug::read_messages(text).value().empty(), "%s", text);
  Talk talk;
  talk.play();
  talk.talk.take_warnings();
  talk.answer("not JSON");
  talk.answer("not JSON");
  ck_assert_uint_eq(talk.talk.take_warnings().size(), 1);
  fail_unless(talk.talk.state() == State::playing);
}

CHECK_MAIN(buttplug_conversation)
