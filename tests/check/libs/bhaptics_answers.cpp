// SPDX-License-Identifier: LGPL-2.1-or-later
//
// bHaptics Players of all kinds, simulated in steps of 1 ms: what waits at them, and whether motors
// that are on stay on.
#include "tactor/drivers/websocket/bhaptics_conversation.h"

#include "support/contains.h"
#include "support/unwrap.h"

#include <deque>
#include <functional>
#include <random>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using State = Conversation::State;

namespace {

struct Habits
{
  Time takes{ 1ms };      ///< for a message, one after the other
  Time news{ 0 };         ///< between statuses that it sends unasked; 0: none
  bool lists = true;      ///< what plays
  int answers_one_in = 1; ///< messages; 0: none
  Time silent_from = 1h;  ///< it answers no message that came later
  Time stalls_from = 1h;  ///< and does nothing
  Time stalls_until = 1h;
  Time slow_from = 1h; ///< 400 ms a message
};

/// A Player with a vest, and the conversation with it. Time begins at 0.
class Player
{
public:
  explicit Player(Habits habits) : habits_(habits)
  {
    talk.begin(now);
    hear();
  }

  /// Plays what `level` says for the first motor, until a time or a failure.
  void run(Time until, const std::function<double(Time)> &level)
  {
    for (; now < until && talk.state() != State::failed; now += 1ms) {
      serve();
      talk.set_levels(std::array{ level(now) });
      while (const std::optional<std::string> text = talk.next(now)) {
        arrived_.push_back({ now, *text });
        sent++;
        if (text->find("turnOff") == std::string::npos) // a zero does not wait its turn
          most_waiting = std::max(most_waiting, arrived_.size() - 1);
      }
      is_wanted_ = level(now) > 0;
      if (is_wanted_ && has_played_ && now >= ends_at_)
        holes++;
      if (!is_wanted_)
        has_played_ = false;
    }
  }

  Time now{ 0 };
  BhapticsConversation talk{ "the Player", unwrap(find_suit_part("vest-back")) };
  std::size_t most_waiting = 0; ///< levels behind the message that it has
  int sent = 0;
  int holes = 0; ///< ms without vibration within a cue, after its begin

private:
  struct Message
  {
    Time at;
    std::string text;
  };

  bool is_on() const
  {
    return now < ends_at_;
  }
  void hear()
  {
    const char *keys = habits_.lists && is_on() ? R"("visuotactile-VestBack","of a game")" : "";
    talk.received(R"({"ActiveKeys":[)" + std::string(keys) + R"(],"ConnectedPositions":["Vest"]})",
                  now);
  }
  void serve()
  {
    if (now >= habits_.stalls_from && now < habits_.stalls_until)
      return;
    if (habits_.news > 0s && now % habits_.news == 0s)
      hear();
    if (arrived_.empty())
      return;
    if (now < std::max(arrived_.front().at, done_at_)
                  + (now < habits_.slow_from ? habits_.takes : Time(400ms)))
      return;
    done_at_ = now;
    const Message message = arrived_.front();
    arrived_.pop_front();
    const std::size_t duration = message.text.find("DurationMillis\":");
    ends_at_ = duration == std::string::npos
                   ? now
                   : now + std::chrono::milliseconds(std::stoi(message.text.substr(duration + 16)));
    has_played_ = has_played_ || is_on();
    taken_++;
    if (habits_.answers_one_in > 0 && taken_ % habits_.answers_one_in == 0
        && message.at < habits_.silent_from)
      hear();
  }

  const Habits habits_;
  std::deque<Message> arrived_;
  Time done_at_{ 0 }; ///< with the last one that it took
  Time ends_at_{ 0 }; ///< the vibration
  int taken_ = 0;
  bool is_wanted_ = false;
  bool has_played_ = false; ///< of this cue
};

double
always(Time)
{
  return 1;
}

/// Cues of 700 ms with breaks of 300 ms, whose level changes with each frame.
double
film(Time now)
{
  if (now % 1s >= 700ms)
    return 0;
  return 0.3 + 0.1 * static_cast<double>(now / 40ms % 7);
}

} // namespace

/// Servers that say nothing unasked, or list what plays, are never sent levels that would wait at
/// them.
CHECK_TEST(test_one_under_way)
{
  for (const Habits &habits :
       { Habits{ .takes = 1ms }, Habits{ .takes = 40ms }, Habits{ .takes = 200ms },
         Habits{ .takes = 200ms, .lists = false }, Habits{ .takes = 200ms, .news = 50ms },
         Habits{ .takes = 120ms, .news = 7ms }, Habits{ .takes = 1ms, .news = 20ms } }) {
    Player player(habits);
    player.run(60s, film);
    fail_unless(player.talk.state() == State::playing, "%s", player.talk.failure().text.c_str());
    const auto ms = habits.takes / 1ms;
    fail_unless(player.most_waiting == 0, "%zu at %ld ms", player.most_waiting, long{ ms });
    // As often as it can be: a message for each frame of the 18 in a cue, and its zero.
    const auto most = std::min(60s / (habits.takes * 2), 60L * 18);
    fail_unless(player.sent >= most, "%d messages at %ld ms", player.sent, long{ ms });
    fail_unless(player.talk.latency() == std::clamp(habits.takes, Time(1ms), Time(150ms)), "%ld ns",
                long{ player.talk.latency().count() });
  }
}

/// One that does both not is sent five messages a second.
CHECK_TEST(test_unasked_and_unlisted)
{
  Player player({ .takes = 190ms, .news = 30ms, .lists = false });
  player.run(60s, film);
  ck_assert_uint_eq(player.most_waiting, 0);
  ck_assert_int_ge(player.sent, 60 * 4);
  ck_assert_int_le(player.sent, 60 * 5 + 1);
}

/// What is on does not flicker, whatever is answered.
CHECK_TEST(test_no_holes)
{
  for (const Habits &habits :
       { Habits{ .takes = 1ms }, Habits{ .takes = 200ms }, Habits{ .takes = 240ms },
         Habits{ .takes = 200ms, .news = 50ms }, Habits{ .news = 20ms, .lists = false },
         Habits{ .answers_one_in = 2 }, Habits{ .lists = false, .answers_one_in = 3 },
         Habits{ .answers_one_in = 0 }, Habits{ .takes = 90ms, .answers_one_in = 0 } }) {
    Player player(habits);
    player.run(60s, always);
    fail_unless(player.talk.state() == State::playing, "%s", player.talk.failure().text.c_str());
    fail_unless(player.holes == 0, "%d ms at %ld ms, one in %d", player.holes,
                long{ habits.takes / 1ms }, habits.answers_one_in);
    ck_assert_int_ge(player.sent, 60 * 2);
  }
}

/// A server that never answered is sent ten messages a second, and the user is told once.
CHECK_TEST(test_never_answers)
{
  Player player({ .answers_one_in = 0 });
  player.run(60s, film);
  fail_unless(player.talk.state() == State::playing);
  ck_assert_int_le(player.sent, 60 * 10);
  ck_assert_int_ge(player.sent, 60 * 7);
  const std::vector<std::string> warnings = player.talk.take_warnings();
  ck_assert_uint_eq(warnings.size(), 1);
  assert_contains(warnings.front(), { "the Player answers nothing", "restart it" });
  fail_unless(player.talk.latency() == 0s);
}

/// One that stopped is left. Until then its motors run.
CHECK_TEST(test_stopped_answering)
{
  Player player({ .silent_from = 10s });
  player.run(60s, always);
  fail_unless(player.talk.state() == State::failed);
  fail_unless(player.now > 15s && player.now < 15s + 200ms);
  ck_assert_int_eq(player.holes, 0);
  assert_contains(player.talk.failure().text, { "expected a status", "none came for 5 s" });
}

/// After a stall nothing waits at the server for long.
CHECK_TEST(test_stall)
{
  Player player({ .takes = 20ms, .stalls_from = 10s, .stalls_until = 13s });
  player.run(13s, film);
  ck_assert_uint_le(player.most_waiting, 15); // each 200 ms
  player.run(15s, film);
  player.most_waiting = 0;
  player.run(60s, film);
  ck_assert_uint_eq(player.most_waiting, 0);
  fail_unless(player.talk.state() == State::playing);
}

/// A server that says nothing unasked and becomes slow is sent what it can take, in 20 s at most.
CHECK_TEST(test_slower)
{
  Player player({ .slow_from = 10s });
  player.run(10s, film);
  ck_assert_uint_eq(player.most_waiting, 0);
  player.run(20s, film);
  ck_assert_uint_le(player.most_waiting, 5); // each 200 ms for a second
  player.run(30s, film);
  player.most_waiting = 0;
  player.run(60s, film);
  ck_assert_uint_le(player.most_waiting, 1);
  fail_unless(player.talk.latency() == 150ms);
  fail_unless(player.talk.state() == State::playing);
}

CHECK_MAIN(bhaptics_answers)
