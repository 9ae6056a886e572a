// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's scheduler: boards that go away, and many threads at once.
#include "scheduler_rig.h"

#include <random>
#include <thread>

/// The film goes on without the board, which is looked for once a second; when it is back it is told all that holds then.
GST_START_TEST(test_board_lost_and_found)
{
  Rig rig;
  std::vector<Command> commands{ command(50, 3, 0.5) };
  for (int i = 0; i < 40; i++)
    commands.push_back(command(100 + i * 100, i % 2, 1.0 + i / 32.0));
  rig.push(commands);
  rig.run_to(350);
  rig.board.set(&Board::refusals, 2);
  rig.board.set(&Board::error, std::optional(Kind::lost)); // at 400
  rig.run_to(3390);
  ck_assert_int_eq(rig.host.lost, 1);
  ck_assert_int_eq(rig.host.found, 0);
  ck_assert_uint_eq(rig.writes().size(), 4);
  rig.run_to(5000);
  ck_assert_int_eq(rig.host.lost, 1);
  ck_assert_int_eq(rig.host.found, 1);
  ck_assert_int_eq(rig.host.failed, 0);
  fail_unless(rig.board.get(&Board::opens)
              == (std::vector<Time>{ milliseconds(1400), milliseconds(2400), milliseconds(3400) }));
  const std::vector<Write> writes = rig.writes();
  fail_unless(writes[3].now == milliseconds(300));
  // At 3400 i is 33, and at most that command is told apart from what held before.
  fail_unless(writes[4].now == milliseconds(3400));
  fail_unless(writes[4].volts == (Volts{ 2.0, 1.96875, 0.0, 0.5 })
              || writes[4].volts == (Volts{ 2.0, 2.03125, 0.0, 0.5 }));
  fail_unless(writes.back() == (Write{ milliseconds(4000), { 2.1875, 2.21875, 0.0, 0.5 } }));
  ck_assert_uint_eq(rig.scheduler->counters().reconnects, 1);
  ck_assert_uint_eq(rig.scheduler->counters().issued, 41);
  ck_assert_uint_eq(rig.scheduler->counters().late, 0);
}
GST_END_TEST;

/// A board that returns while nothing in the film changes is found as well.
GST_START_TEST(test_board_found_while_the_film_rests)
{
  Rig rig;
  rig.push({ command(100, 1, 2.0) });
  rig.board.set(&Board::error, std::optional(Kind::lost));
  rig.board.set(&Board::refusals, 1);
  rig.run_to(2500);
  fail_unless(rig.board.get(&Board::opens)
              == (std::vector<Time>{ milliseconds(1100), milliseconds(2100) }));
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(2100), { 0.0, 2.0 } } }));

  // Lost again with the first write after that: told again.
  rig.board.set(&Board::error, std::optional(Kind::lost));
  rig.push({ command(2600, 1, 1.0) });
  rig.run_to(2700);
  ck_assert_int_eq(rig.host.lost, 2);
  rig.run_to(4000);
  ck_assert_int_eq(rig.host.found, 2);
  fail_unless(rig.writes().back() == (Write{ milliseconds(3600), { 0.0, 1.0 } }));
}
GST_END_TEST;

/// Not looked for in a pause; a seek, after which running time begins anew, does not put the search off.
GST_START_TEST(test_board_lost_pause_and_seek)
{
  Rig rig;
  rig.push({ command(9000, 1, 2.0) });
  rig.board.set(&Board::error, std::optional(Kind::lost));
  rig.board.set(&Board::refusals, 1);
  rig.run_to(9500);
  rig.scheduler->pause();
  fail_unless(rig.board.is_silent());
  gst_test_clock_advance_time(rig.clock, 2 * GST_SECOND); // running time 11.5 s
  rig.scheduler->timing_changed();
  rig.scheduler->flush();
  fail_unless(rig.board.get(&Board::opens).empty());
  rig.offset += milliseconds(11500);
  rig.host.set(GST_CLOCK(rig.clock), rig.offset);
  rig.scheduler->play();
  rig.push({ command(200, 0, 1.0) });
  rig.run_to(2500);
  fail_unless(rig.board.get(&Board::opens)
              == (std::vector<Time>{ milliseconds(1000), milliseconds(2000) }));
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(2000), { 1.0 } } }));
  ck_assert_int_eq(rig.host.lost, 1);
  ck_assert_int_eq(rig.host.found, 1);
}
GST_END_TEST;

/// Lost in the middle of being silenced: its motors stand, and whoever waits for that is let go.
GST_START_TEST(test_board_lost_while_pausing)
{
  Rig rig;
  rig.push({ command(100, 1, 2.0) });
  rig.run_to(200);
  rig.board.set(&Board::error, std::optional(Kind::lost));
  rig.scheduler->pause();
  ck_assert_int_eq(rig.host.lost, 1);
  rig.scheduler->play();
  rig.run_to(1300);
  fail_unless(rig.writes().back() == (Write{ milliseconds(1200), { 0.0, 2.0 } }));
}
GST_END_TEST;

/// A board with fewer motors than the film uses is not the one that was lost.
GST_START_TEST(test_smaller_board_is_not_taken)
{
  Rig rig;
  rig.push({ command(100, 3, 2.0) });
  rig.board.set(&Board::error, std::optional(Kind::lost));
  rig.run_to(500);
  rig.board.set(&Board::tactors, 2);
  rig.run_to(1500);
  ck_assert_int_eq(rig.host.found, 0);
  fail_if(rig.board.get(&Board::open));
  rig.board.set(&Board::tactors, 4);
  rig.run_to(2500);
  ck_assert_int_eq(rig.host.found, 1);
  fail_unless(rig.writes()
              == (std::vector<Write>{ { milliseconds(2100), { 0.0, 0.0, 0.0, 2.0 } } }));
}
GST_END_TEST;

GST_START_TEST(test_board_failed)
{
  for (const bool odd : { false, true }) {
    Rig rig;
    rig.push({ command(100, 0, 1.0), command(200, 0, 2.0), command(300, 0, 3.0),
               command(9000, 1, 1.0) });
    rig.run_to(150);
    if (odd)
      rig.board.set(&Board::odd_error, true);
    else
      rig.board.set(&Board::error, std::optional(Kind::failed));
    rig.run_to(9500);
    ck_assert_int_eq(rig.host.failed, 1);
    ck_assert_int_eq(rig.host.lost, 0);
    ck_assert_uint_eq(rig.writes().size(), 1);
    fail_unless(rig.board.get(&Board::opens).empty());
    fail_unless(rig.board.get(&Board::destroyed));
    rig.scheduler->pause();
    rig.scheduler->play();
    rig.scheduler->flush();
    rig.scheduler->set_muted(true);
    ck_assert_int_eq(rig.host.failed, 1);
  }
}
GST_END_TEST;

/// What the host is told it may answer, on the scheduler's thread, with anything but stop().
GST_START_TEST(test_host_calls_back)
{
  Rig rig;
  rig.host.on_lost = [&] {
    rig.scheduler->set_muted(true);
  };
  rig.board.set(&Board::error, std::optional(Kind::lost));
  rig.push({ command(100, 0, 1.0) });
  rig.run_to(1500);
  ck_assert_int_eq(rig.host.lost, 1);
  ck_assert_int_eq(rig.host.found, 1);
  fail_unless(rig.writes().empty()); // it is back, and muted
}
GST_END_TEST;

/// Beginning and ending while others push, ask and mute.
GST_START_TEST(test_start_and_stop_against_others)
{
  Rig rig;
  std::atomic<bool> done{ false };
  std::thread asker([&] {
    for (bool muted = false; !done; muted = !muted) {
      rig.scheduler->set_muted(muted);
      rig.scheduler->counters();
      rig.scheduler->trace_failed();
      rig.scheduler->timing_changed();
    }
  });
  for (int i = 0; i < 200; i++) {
    rig.push({ command(0, i % 4, 1.0) });
    std::thread other([&] { rig.scheduler->stop(); });
    rig.scheduler->stop();
    fail_unless(rig.board.is_silent());
    fail_if(rig.board.get(&Board::open));
    other.join();
    rig.start();
    rig.scheduler->play();
  }
  done = true;
  asker.join();
}
GST_END_TEST;

/// Everything at once, with a board that comes and goes. One thread alone pauses and plays, and finds the motors at zero between.
GST_START_TEST(test_many_threads)
{
  for (unsigned seed = 1; seed <= 25; seed++) {
    Rig rig;
    std::atomic<int> busy{ 0 };
    std::vector<std::thread> threads;
    const auto thread = [&](int times, auto work) {
      busy++;
      threads.emplace_back(
          [&, times, work, random = std::mt19937(seed * 100 + threads.size())]() mutable {
            for (int i = 0; i < times; i++)
              work(random);
            busy--;
          });
    };
    const auto ms_now = [&] {
      return static_cast<int>(rig.running() / milliseconds(1));
    };
    for (int i = 0; i < 2; i++)
      thread(1500, [&](std::mt19937 &random) {
        std::vector<Command> commands;
        for (unsigned n = random() % 5; n > 0; n--) {
          commands.push_back(
              command(ms_now() + static_cast<int>(random() % 60), static_cast<int>(random() % 4),
                      0.5 * static_cast<double>(random() % 4), static_cast<int>(random() % 60)));
          commands.back().until = commands.back().effect + milliseconds(random() % 100);
        }
        rig.push(commands, rig.running() + milliseconds(random() % 100));
      });
    thread(400, [&](std::mt19937 &) {
      rig.scheduler->pause();
      for (int look = 0; look < 20; look++) {
        ck_assert(rig.board.is_silent());
        std::this_thread::yield();
      }
      rig.scheduler->play();
    });
    for (int i = 0; i < 3; i++)
      thread(300, [&](std::mt19937 &random) {
        switch (random() % 5) {
        case 0:
          rig.scheduler->flush();
          break;
        case 2:
          rig.scheduler->set_ramp_in(milliseconds(random() % 100));
          break;
        case 1:
          rig.scheduler->set_immediate(random() % 4 == 0);
          break;
        default:
          rig.scheduler->set_muted(random() % 2 == 0);
        }
      });
    thread(300, [&](std::mt19937 &random) {
      rig.scheduler->timing_changed();
      rig.scheduler->take_starved();
      if (random() % 16 == 0) {
        rig.board.set(&Board::refusals, static_cast<int>(random() % 2));
        rig.board.set(&Board::error, std::optional(Kind::lost));
      }
    });
    std::mt19937 random(seed);
    while (busy > 0) {
      gst_test_clock_advance_time(rig.clock, (random() % 20) * GST_MSECOND);
      GstClockID id = nullptr;
      if (gst_test_clock_peek_next_pending_id(rig.clock, &id)) {
        gst_clock_id_unref(id);
        if (GstClockID ended = gst_test_clock_process_next_clock_id(rig.clock))
          gst_clock_id_unref(ended);
      }
      std::this_thread::yield();
    }
    for (std::thread &one : threads)
      one.join();
    rig.scheduler->stop();
    fail_unless(rig.board.is_silent());
    const int away = rig.host.lost - rig.host.found;
    fail_unless(away == 0 || away == 1);
    ck_assert_uint_eq(rig.scheduler->counters().reconnects, static_cast<guint64>(rig.host.found));
  }
}
GST_END_TEST;

static Suite *
tactorscheduler_boards_suite(void)
{
  Suite *suite = suite_create("tactorscheduler_boards");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_test(cases, test_board_lost_and_found);
  tcase_add_test(cases, test_board_found_while_the_film_rests);
  tcase_add_test(cases, test_board_lost_pause_and_seek);
  tcase_add_test(cases, test_board_lost_while_pausing);
  tcase_add_test(cases, test_smaller_board_is_not_taken);
  tcase_add_test(cases, test_board_failed);
  tcase_add_test(cases, test_host_calls_back);
  tcase_add_test(cases, test_start_and_stop_against_others);
  tcase_add_test(cases, test_many_threads);
  return suite;
}

GST_CHECK_MAIN(tactorscheduler_boards);
