// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The player that is followed, at set times: what a listener still hears of a film that has
// stopped is not felt.
#include "visuotactile-follow/player_choice.h"

#include "support/unwrap.h"

#include <vector>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using follow::Doing;
using follow::Time;

namespace {

constexpr std::size_t kMpv = 0;
constexpr std::size_t kEar = 1;

struct Room
{
  Room()
  {
    players.push_back({ .doing = Doing::playing });
    players.push_back({ .doing = Doing::playing, .source = follow::Source::listener });
  }

  PlayerChoice choice{};
  std::vector<PlayerChoice::Candidate> players{};
  std::optional<std::size_t> followed{};

  std::size_t at(Time now)
  {
    followed = choice.choose(players, followed, now);
    return followed.value_or(99);
  }
};

} // namespace

/// The sound of a player that pauses, seeks, ends or leaves is heard for some seconds more.
CHECK_TEST(test_stopped)
{
  for (const Doing doing : { Doing::paused, Doing::stalled, Doing::stopped }) {
    Room room;
    room.players[kEar].found = 3s;
    fail_unless(room.at(20s) == kMpv);
    room.players[kMpv].doing = doing;
    for (Time now = 20s; now < 30s; now += 20ms)
      fail_unless(room.at(now) == kMpv, "%d at %.2f s", static_cast<int>(doing),
                  std::chrono::duration<double>(now).count());
    // A search in sound that is mostly the player's finds it again.
    room.players[kEar].found = 25s;
    fail_unless(room.at(30s) == kMpv);
    room.players[kMpv].doing = Doing::playing;
    fail_unless(room.at(31s) == kMpv);
  }
  Room room;
  fail_unless(room.at(20s) == kMpv);
  const std::vector<PlayerChoice::Candidate> ear{ room.players[kEar] };
  fail_if(room.choice.choose(ear, std::nullopt, 21s).has_value(), "of a player that has left");
}

/// Another film, or the same one at another screen.
CHECK_TEST(test_heard_after)
{
  Room room;
  fail_unless(room.at(20s) == kMpv);
  room.players[kMpv].doing = Doing::paused;
  room.players[kEar].found = 33s;
  fail_unless(room.at(33s) == kEar);
  room.players[kMpv].doing = Doing::playing;
  fail_unless(room.at(40s) == kMpv);
  room.players[kMpv].doing = Doing::paused;
  fail_unless(room.at(41s) == kMpv);
  fail_unless(room.at(63s) == kMpv);
  fail_unless(room.at(64s) == kEar, "still heard, so it is another screen's");
}

CHECK_TEST(test_ranks)
{
  Room room;
  room.players[kMpv].doing = Doing::paused;
  fail_unless(room.at(1s) == kEar, "nothing was followed before");
  room.players[kEar].doing = Doing::stalled;
  fail_unless(room.at(2s) == kEar, "a paused film is prepared only where none is");
  room.players[kMpv] = { .doing = Doing::playing, .is_faulty = true };
  fail_unless(room.at(3s) == kMpv);
  room.players[kEar].doing = Doing::playing;
  fail_unless(room.at(4s) == kEar, "its position is of no use");
  Room none;
  none.players = { { .doing = Doing::stopped },
                   { .doing = Doing::stalled, .source = follow::Source::listener } };
  fail_unless(none.at(1s) == 99);
  none.players[0].doing = Doing::paused;
  fail_unless(none.at(2s) == 0);
  none.players[0].doing = Doing::stopped;
  none.players.push_back({ .doing = Doing::paused });
  fail_unless(none.at(3s) == 2);
}

/// The film of a television whose media server reports it to the second, and which is heard, too.
CHECK_TEST(test_media_server)
{
  Room room;
  room.players[0].source = follow::Source::media_server;
  room.players[kEar].doing = Doing::stopped;
  fail_unless(room.at(10s) == 0);
  room.players[kEar]
      = { .doing = Doing::playing, .source = follow::Source::listener, .found = 14s };
  fail_unless(room.at(15s) == kEar, "it is more exact");
  // The server knows of a pause before it is heard.
  room.players[0].doing = Doing::paused;
  for (Time now = 15s; now < 20s; now += 20ms)
    fail_unless(room.at(now) == 0, "%.2f s", std::chrono::duration<double>(now).count());
  room.players[kEar].doing = Doing::stalled;
  room.players[0].doing = Doing::playing;
  fail_unless(room.at(21s) == 0);
  room.players[kEar]
      = { .doing = Doing::playing, .source = follow::Source::listener, .found = 23s };
  fail_unless(room.at(24s) == kEar);
  // Another film is heard long after.
  room.players[0].doing = Doing::stopped;
  fail_unless(room.at(25s) != kEar);
  room.players[kEar].found = 60s;
  fail_unless(room.at(61s) == kEar);
  // A player that reports exactly comes before both.
  room.players.push_back({ .doing = Doing::playing });
  fail_unless(room.at(62s) == 2);
}

CHECK_MAIN(player_choice)
