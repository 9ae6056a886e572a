// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/opening_turn.h"

#include <optional>
#include <thread>

#include "support/check_tests.h"

using tactor::OpeningTurn;

CHECK_TEST(test_in_order)
{
  const std::stop_token never;
  std::optional<OpeningTurn> first(std::in_place);
  std::optional<OpeningTurn> second(std::in_place);
  std::optional<OpeningTurn> third(std::in_place);
  fail_unless(first->wait(never));
  fail_unless(first->wait(never)); // may be repeated

  // A stopped wait reports that its turn did not come.
  std::stop_source stop;
  bool had_turn = true;
  std::thread stopped([&] { had_turn = third->wait(stop.get_token()); });
  stop.request_stop();
  stopped.join();
  fail_if(had_turn);

  // One that leaves the queue is skipped. The turn passes on when its owner is destroyed.
  second.reset();
  std::thread waiting([&] { had_turn = third->wait(never); });
  first.reset();
  waiting.join();
  fail_unless(had_turn);
  const OpeningTurn fourth;
  stop.request_stop();
  fail_if(fourth.wait(stop.get_token()));
}

CHECK_MAIN(opening_turn)
