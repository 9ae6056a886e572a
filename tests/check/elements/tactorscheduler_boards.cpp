// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's scheduler with boards that need a refresh, boards that fail, and many threads.
#include "scheduler_rig.h"

#include <random>
#include <thread>

#include "support/check_tests.h"

/// A board that checks that its host is alive gets the same levels again while a motor is on.
CHECK_TEST(test_refresh)
{
  SchedulerRig rig(false);
  rig.scheduler->stop();
  rig.board.set(&Board::refresh_interval, Time(milliseconds(100)));
  rig.start();
  rig.scheduler->play();
  rig.push({ command(1000, 0, 2.0), command(1250, 1, 1.0), command(1500, 0, 0.0),
             command(1500, 1, 0.0) });
  rig.run_to(3000);
  const Volts one{ 2.0 };
  const Volts both{ 2.0, 1.0 };
  fail_unless(rig.writes()
              == (std::vector<Write>{ { milliseconds(1000), one },
                                      { milliseconds(1100), one },
                                      { milliseconds(1200), one },
                                      { milliseconds(1250), both },
                                      { milliseconds(1350), both },
                                      { milliseconds(1450), both },
                                      { milliseconds(1500), { 0.0, 0.0 } } }));
  ck_assert_uint_eq(rig.scheduler->driver_status().bytes, 7);

  // Not while paused or muted. A seek, after which running time restarts, does not delay it.
  rig.push({ command(3500, 0, 2.0) });
  rig.run_to(3650);
  rig.scheduler->pause();
  gst_test_clock_advance_time(rig.clock, GST_SECOND);
  const std::size_t before = rig.writes().size();
  fail_unless(rig.board.is_silent());
  rig.offset += milliseconds(4650);
  rig.host.set(GST_CLOCK(rig.clock), rig.offset);
  rig.scheduler->play(); // at running time 0, with the last levels
  rig.run_to(150);
  fail_unless(rig.writes().size() == before + 2);
  fail_unless(rig.writes().back() == (Write{ milliseconds(100), { 2.0, 0.0 } }));
  rig.scheduler->set_muted(true);
  rig.run_to(1000);
  fail_unless(rig.writes().size() == before + 3);
  fail_unless(rig.board.is_silent());

  rig.scheduler->stop();
  fail_if(rig.scheduler->driver_status().is_there);
  ck_assert_uint_eq(rig.scheduler->driver_status().bytes, rig.writes().size());
}

/// The same without a clock, by the computer's time.
CHECK_TEST(test_refresh_without_clock)
{
  SchedulerRig rig(false);
  rig.scheduler->stop();
  rig.board.set(&Board::refresh_interval, Time(milliseconds(1)));
  rig.start();
  rig.scheduler->set_immediate(true);
  rig.scheduler->play();
  rig.push({ command(1000, 0, 2.0) });
  std::unique_lock lock(rig.board.mutex);
  rig.board.changed.wait(lock, [&] { return rig.board.writes.size() >= 5; });
  fail_unless(rig.board.writes.back() == (Write{ milliseconds(1000), { 2.0 } }));
}

/// A command that arrived after it was due counts as late by its map. One that waited for the
/// thread counts as late by the thread.
CHECK_TEST(test_cause_of_lateness)
{
  SchedulerRig rig;
  rig.push({ command(9000, 1, 1.0) });
  rig.run_to(100);
  rig.scheduler->push(std::vector{ command(60, 0, 1.0) }, kForever, milliseconds(100));
  rig.board.wait_until([&] { return rig.board.writes.size() == 1; });
  rig.scheduler->push(std::vector{ command(200, 0, 2.0) }, kForever, milliseconds(100));
  rig.jump_to(milliseconds(220));
  rig.board.wait_until([&] { return rig.board.writes.size() == 2; });
  rig.asleep();
  const TactorScheduler::Counters counters = rig.scheduler->counters();
  ck_assert_uint_eq(counters.late, 2);
  ck_assert_uint_eq(counters.came_late, 1);
  ck_assert_uint_eq(counters.thread_late, 1);
  fail_unless(counters.error.max() == milliseconds(40));
  fail_unless(counters.thread_error.max() == milliseconds(20));
  fail_unless(counters.thread_error.min() == Time(0));
}

CHECK_TEST(test_board_failed)
{
  SchedulerRig rig;
  rig.push(
      { command(100, 0, 1.0), command(200, 0, 2.0), command(300, 0, 3.0), command(9000, 1, 1.0) });
  rig.run_to(150);
  rig.board.set(&Board::error, std::optional(Kind::failed));
  rig.run_to(9500);
  ck_assert_int_eq(rig.host.failed, 1);
  ck_assert_uint_eq(rig.writes().size(), 1);
  fail_unless(rig.board.get(&Board::destroyed));
  rig.scheduler->pause();
  rig.scheduler->play();
  rig.scheduler->flush();
  rig.scheduler->set_muted(true);
  ck_assert_int_eq(rig.host.failed, 1);
}

/// The host may call back on the scheduler's thread, except for stop().
CHECK_TEST(test_host_calls_back)
{
  SchedulerRig rig;
  rig.host.on_failed = [&] {
    rig.scheduler->set_muted(true);
    rig.scheduler->counters();
    rig.scheduler->driver_status();
  };
  rig.board.set(&Board::error, std::optional(Kind::failed));
  rig.push({ command(100, 0, 1.0) });
  rig.run_to(100);
  rig.scheduler->pause(); // returns after the host's callback
  ck_assert_int_eq(rig.host.failed, 1);
  fail_unless(rig.scheduler->failed());
  fail_unless(rig.writes().empty());
}

/// Start and stop while others push, query and mute.
CHECK_TEST(test_start_and_stop_while_others_call)
{
  SchedulerRig rig;
  std::atomic<bool> done{ false };
  std::thread asker([&] {
    for (bool muted = false; !done; muted = !muted) {
      rig.scheduler->set_muted(muted);
      rig.scheduler->counters();
      rig.scheduler->driver_status();
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

/// All at once, with a board that needs a refresh. Only one thread pauses and plays, and checks
/// that motors are off in between.
CHECK_TEST(test_many_threads)
{
  for (unsigned seed = 1; seed <= 25; seed++) {
    SchedulerRig rig(false);
    rig.scheduler->stop();
    rig.board.set(&Board::refresh_interval, Time(milliseconds(seed % 2 * 10)));
    rig.start();
    rig.scheduler->play();
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
        switch (random() % 6) {
        case 0:
          rig.scheduler->flush();
          break;
        case 1:
          rig.scheduler->set_immediate(random() % 4 == 0);
          break;
        case 2:
          rig.scheduler->set_ramp_in(milliseconds(random() % 100));
          break;
        case 3:
          rig.scheduler->set_board_away(random() % 2 == 0);
          break;
        default:
          rig.scheduler->set_muted(random() % 2 == 0);
        }
      });
    thread(300, [&](std::mt19937 &) {
      rig.scheduler->timing_changed();
      rig.scheduler->take_starved();
      rig.scheduler->driver_status();
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
    ck_assert_int_eq(rig.host.failed, 0);
  }
}

CHECK_MAIN(tactorscheduler_boards)
