// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Conversations with bHaptics Player, byte for byte, in times of their own. Expected messages are
// written by hand after the published protocol.
#include "tactor/drivers/websocket/bhaptics_conversation.h"

#include "support/contains.h"
#include "support/unwrap.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using State = Conversation::State;

namespace {

const char *const kVest = R"({"RegisteredKeys":[],"ActiveKeys":[],"ConnectedDeviceCount":1,)"
                          R"("ConnectedPositions":["Vest"],"Status":{"VestBack":[0,0]}})";
const char *const kBackOff = R"({"Submit":[{"Type":"turnOff","Key":"visuotactile-VestBack"}]})";

struct Talk
{
  explicit Talk(const char *part = "vest-back") : talk("the Player", unwrap(find_suit_part(part)))
  {
    talk.begin(now);
  }

  void expect(const std::string &text)
  {
    const std::optional<std::string> next = talk.next(now);
    fail_unless(next.has_value(), "no '%s'", text.c_str());
    assert_text(*next, text);
    expect_none();
  }
  void expect_none()
  {
    const std::optional<std::string> next = talk.next(now);
    fail_if(next.has_value(), "%s", next ? next->c_str() : "");
  }
  void answer(const char *status = kVest)
  {
    talk.received(status, now);
  }
  /// From the beginning to playing, with a server that answers and says no more.
  void play(const char *status = kVest)
  {
    answer(status);
    fail_unless(talk.next(now).has_value());
    answer(status);
    expect_none();
    fail_unless(talk.state() == State::asking && talk.deadline() == now + 500ms);
    now += 500ms;
    expect_none();
    fail_unless(talk.state() == State::playing, "%s", talk.failure().text.c_str());
    now += 500ms;
  }

  Time now = 10s;
  BhapticsConversation talk;
};

/// The message that sets dots of VestBack, "INDEX,INTENSITY" each.
std::string
back(std::initializer_list<std::pair<int, int>> dots, int ms = 250)
{
  std::string text;
  for (const auto &[index, intensity] : dots)
    text += (text.empty() ? "" : ",") + std::string("{\"Index\":") + std::to_string(index)
            + ",\"Intensity\":" + std::to_string(intensity) + "}";
  return R"({"Submit":[{"Type":"frame","Key":"visuotactile-VestBack","Frame":)"
         R"({"Position":"VestBack","DurationMillis":)"
         + std::to_string(ms) + R"(,"DotPoints":[)" + text + "]}}]}";
}

} // namespace

CHECK_TEST(test_levels)
{
  Talk talk;
  fail_unless(talk.talk.state() == State::asking);
  talk.expect_none();
  talk.answer();
  talk.expect(kBackOff); // whatever it did before
  talk.answer();
  talk.now += 500ms;
  talk.expect_none();
  fail_unless(talk.talk.state() == State::playing);
  ck_assert_int_eq(talk.talk.device().tactors, 20);
  fail_unless(talk.talk.device().has_watchdog && talk.talk.device().longest_latency == 150ms);
  talk.talk.set_levels(std::array{ 0.0, 0.5, 1.0, 7.0, -1.0, std::nan("") });
  talk.expect(back({ { 1, 50 }, { 2, 100 }, { 3, 100 } }));
  talk.answer();
  talk.now += 20ms;
  talk.talk.set_levels({});
  talk.expect(kBackOff);
}

/// bhaptics-linux takes an intensity of 1 for the whole. Nothing is that weak.
CHECK_TEST(test_intensity)
{
  ck_assert_int_eq(bhaptics::intensity(0.004), 0);
  ck_assert_int_eq(bhaptics::intensity(0.01), 2);
  ck_assert_int_eq(bhaptics::intensity(0.02), 2);
  ck_assert_int_eq(bhaptics::intensity(1), 100);
}

/// Motors that are on are told so again before their duration ends; others are not.
CHECK_TEST(test_renewal)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect(back({ { 0, 100 } }));
  talk.answer();
  fail_unless(talk.talk.deadline() == talk.now + 100ms);
  talk.now += 99ms;
  talk.expect_none();
  talk.now += 1ms;
  talk.expect(back({ { 0, 100 } }));
  talk.answer();
  talk.now += 20ms;
  talk.talk.set_levels({});
  talk.expect(kBackOff);
  talk.answer();
  fail_if(talk.talk.deadline().has_value());
}

/// While the server has not answered a message, the next one waits, and has the newest levels.
CHECK_TEST(test_one_message_under_way)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 0.1 });
  talk.expect(back({ { 0, 10 } }));
  for (const double level : { 0.2, 0.3, 0.4 }) {
    talk.now += 60ms;
    talk.talk.set_levels(std::array{ level });
    talk.expect_none();
  }
  talk.now += 20ms; // 200 ms after the message
  talk.answer();
  fail_unless(talk.talk.latency() == 150ms); // as planned for
  talk.expect(back({ { 0, 40 } }, 450));
  // Overdue after twice the usual time. The motors run until then.
  talk.talk.set_levels(std::array{ 0.5 });
  for (int i = 0; i < 3; i++) {
    fail_unless(talk.talk.deadline() == talk.now + 400ms);
    talk.now += 400ms;
    talk.expect(back({ { 0, 50 } }, 450));
  }
}

/// A zero is sent at once, whatever is under way; other levels wait. So does a zero for a server
/// that usually takes more than 50 ms: it would wait there.
CHECK_TEST(test_a_zero_waits_for_no_answer)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 0.5, 0.3 });
  talk.expect(back({ { 0, 50 }, { 1, 30 } }));
  talk.now += 1ms;
  talk.talk.set_levels(std::array{ 0.0, 0.8 });
  fail_unless(talk.talk.deadline() <= talk.now);
  talk.expect(back({ { 1, 30 } }));
  talk.now += 1ms;
  talk.talk.set_levels({});
  talk.expect(kBackOff);
  talk.now += 1ms;
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect_none();
  talk.now += 199ms; // overdue
  talk.expect(back({ { 0, 100 } }));

  Talk slow;
  slow.play();
  for (const double level : { 0.1, 0.2, 0.3 }) {
    slow.talk.set_levels(std::array{ level });
    fail_unless(slow.talk.next(slow.now).has_value());
    slow.now += 60ms;
    slow.answer();
  }
  slow.talk.set_levels(std::array{ 1.0 });
  fail_unless(slow.talk.next(slow.now).has_value());
  slow.now += 50ms;
  slow.talk.set_levels({});
  slow.expect_none();
  slow.now += 10ms;
  slow.answer();
  slow.expect(kBackOff);
}

/// A server that answers nothing is left.
CHECK_TEST(test_silent_server)
{
  Talk talk;
  fail_unless(talk.talk.deadline() == talk.now + 500ms);
  talk.now += 500ms;
  talk.expect(kBackOff); // it may answer, if it sends nothing by itself
  const std::optional<Time> silent = talk.talk.deadline();
  fail_unless(silent == talk.now + 5s);
  talk.now += 5s;
  talk.expect_none();
  fail_unless(talk.talk.state() == State::failed);
  assert_contains(talk.talk.failure().text, { "the Player", "none came for 5 s" });

  Talk later;
  later.play();
  later.now += 1h; // a pause is no silence
  later.talk.set_levels(std::array{ 1.0 });
  later.expect(back({ { 0, 100 } }));
  int sent = 1;
  while (later.talk.state() == State::playing) {
    later.now = later.talk.deadline().value();
    sent += later.talk.next(later.now) ? 1 : 0;
  }
  fail_unless(later.now == 3611s + 5s);
  ck_assert_int_eq(sent, 25); // each 200 ms
  assert_contains(later.talk.failure().text, { "none came for 5 s" });
}

CHECK_TEST(test_vest_of_two_sides)
{
  Talk talk("vest");
  talk.play();
  ck_assert_int_eq(talk.talk.device().tactors, 40);
  fail_unless(talk.talk.device().layout == (Layout{ 5, 4, 2 }));
  const std::vector<std::string> motors = talk.talk.device().motors;
  ck_assert_int_eq(static_cast<int>(motors.size()), 40);
  assert_text(motors[5], "back, row 2, column 2");
  assert_text(motors[39], "front, row 5, column 4");
  std::array<double, 40> levels{};
  levels[39] = 1; // the last one of the front
  talk.talk.set_levels(levels);
  talk.expect(R"({"Submit":[{"Type":"frame","Key":"visuotactile-VestFront","Frame":)"
              R"({"Position":"VestFront","DurationMillis":250,)"
              R"("DotPoints":[{"Index":19,"Intensity":100}]}}]})");
  talk.answer();
  talk.now += 20ms;
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect(R"({"Submit":[{"Type":"frame","Key":"visuotactile-VestBack","Frame":)"
              R"({"Position":"VestBack","DurationMillis":250,)"
              R"("DotPoints":[{"Index":0,"Intensity":100}]}},)"
              R"({"Type":"turnOff","Key":"visuotactile-VestFront"}]})");
  // Before its turn a side that stops is told so alone.
  talk.now += 1ms;
  talk.talk.set_levels(levels);
  talk.expect(kBackOff);
}

/// The left columns are the left arm's. One sleeve will do, and the other is missed once.
CHECK_TEST(test_sleeves)
{
  Talk talk("sleeves");
  const char *status = R"({"ConnectedPositions":["ForearmR","Head"]})";
  talk.play(status);
  const std::vector<std::string> warnings = talk.talk.take_warnings();
  ck_assert_uint_eq(warnings.size(), 1);
  assert_contains(warnings.front(), { "ForearmL is not connected" });
  assert_text(talk.talk.device().motors.at(6 + 2), "left arm, row 2, column 3");
  assert_text(talk.talk.device().motors.at(3), "right arm, row 1, column 1");
  std::array<double, 12> levels{};
  levels[6 + 2] = levels[3] = 1; // second row of the left arm, first one of the right
  talk.talk.set_levels(levels);
  talk.expect(R"({"Submit":[{"Type":"frame","Key":"visuotactile-ForearmL","Frame":)"
              R"({"Position":"ForearmL","DurationMillis":250,)"
              R"("DotPoints":[{"Index":5,"Intensity":100}]}},)"
              R"({"Type":"frame","Key":"visuotactile-ForearmR","Frame":)"
              R"({"Position":"ForearmR","DurationMillis":250,)"
              R"("DotPoints":[{"Index":0,"Intensity":100}]}}]})");
}

CHECK_TEST(test_not_connected)
{
  Talk talk("visor");
  talk.answer();
  fail_unless(talk.talk.failure().kind == DriverError::Kind::not_found);
  assert_contains(talk.talk.failure().text, { "expected Head", "only Vest is connected" });
  // Also in the middle of a film.
  Talk lost;
  lost.play();
  lost.answer(R"({"ConnectedPositions":[]})");
  fail_unless(lost.talk.state() == State::failed);
  assert_contains(lost.talk.failure().text, { "nothing is connected", "switch it on" });
  // bhaptics-linux wakes a vest that it let go.
  Talk asleep;
  asleep.play(R"({"ConnectedPositions":[],"VestIdle":true})");
}

/// The status that the server sends by itself is not the answer to the first message, which is
/// waited for.
CHECK_TEST(test_first_answer)
{
  Talk talk;
  talk.answer();
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect(kBackOff);
  talk.now += 30ms;
  talk.answer();
  talk.now += 469ms;
  talk.expect_none();
  talk.now += 1ms;
  talk.expect(back({ { 0, 100 } }));
  fail_unless(talk.talk.latency() == 30ms);
}

CHECK_TEST(test_close)
{
  Talk talk;
  talk.play();
  talk.talk.set_levels(std::array{ 1.0 });
  talk.expect(back({ { 0, 100 } }));
  talk.talk.close(talk.now); // though the last message was not answered
  talk.expect(kBackOff);
  fail_unless(talk.talk.state() == State::closed);
  // Also after a failure.
  Talk failed;
  failed.play();
  failed.answer(R"({"ConnectedPositions":[]})");
  failed.talk.close(failed.now);
  failed.expect(kBackOff);
}

CHECK_TEST(test_other_messages)
{
  for (const char *text : { "", "[]", "{}", "null", "{", R"({"ConnectedPositions":{}})",
                            R"({"ConnectedPositions":"Vest"})", R"({"AudioMeter":{"on":true}})",
                            "/*\"*/{}", "\xff\xfe" })
    fail_if(bhaptics::read_status(text).has_value(), "%s", text);
  fail_if(bhaptics::read_status(std::string(100'000, '[')).has_value());
  const auto odd = bhaptics::read_status(R"({"ConnectedPositions":[1,null,{},"Ve\nst"]})");
  fail_unless(odd.has_value());
  assert_text(odd->positions[3], "Ve?st");
}

CHECK_TEST(test_names)
{
  assert_text(std::string(unwrap(find_suit_part("")).name), "vest-back");
  const DriverError error = refusal_of(find_suit_part("boots"));
  assert_contains(error.text, { "'boots'", "vest-back, vest-front, vest, sleeves", "visor" });
}

CHECK_MAIN(bhaptics_conversation)
