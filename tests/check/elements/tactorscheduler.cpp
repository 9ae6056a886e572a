// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's scheduler: exact times, the ways to silence, boards that go away, and many threads at once.
#include "scheduler_rig.h"

#include <map>
#include <random>
#include <thread>

namespace {

/// What the motors are told in the tests where each command is a write of its own, worked out anew: sorted by due time,
/// later ones of the same tactor and time win, and nothing is written that changes nothing.
std::vector<Write>
expected_writes(std::vector<Command> commands)
{
  std::ranges::stable_sort(commands, {}, &Command::due);
  std::vector<Write> writes;
  std::map<Time, std::vector<Command>> by_due;
  for (const Command &command : commands)
    by_due[command.due()].push_back(command);
  std::array<double, 4> now{};
  for (const auto &[due, together] : by_due) {
    const auto before = now;
    for (const Command &command : together)
      now[static_cast<std::size_t>(command.tactor)] = command.volts;
    if (now != before)
      writes.push_back({ due, { now.begin(), now.end() } });
  }
  return writes;
}

/// A board need not be told of tactors that never did anything: silence is appended.
std::vector<Write>
padded(std::vector<Write> writes)
{
  for (Write &write : writes)
    write.volts.resize(4, 0.0);
  return writes;
}

/// Runs work() while the board is inside a write of nonzero volts that ends only afterwards, and waits for both.
void
during_a_write(Rig &rig, const std::function<void()> &work)
{
  rig.push({ command(100, 1, 2.0) });
  rig.run_to(50);
  rig.board.set(&Board::hold, true);
  rig.jump_to(milliseconds(100));
  rig.board.wait_until_held();
  std::thread other(work);
  std::this_thread::yield(); // either order has to be right
  rig.board.set(&Board::hold, false);
  other.join();
}

} // namespace

/// Commands pushed in any order are written at their due time to the nanosecond, and traced so.
GST_START_TEST(test_issued_exactly_when_due)
{
  for (unsigned seed = 1; seed <= 20; seed++) {
    Rig rig;
    std::mt19937 random(seed);
    const auto upto = [&](int n) {
      return static_cast<int>(random() % static_cast<unsigned>(n));
    };
    std::vector<Command> all;
    for (int batch = 0; batch < 10; batch++) {
      std::vector<Command> commands;
      for (int i = upto(8); i > 0; i--) {
        const int lead = upto(180);
        Command one = command(batch * 200 + lead + 1 + upto(199), upto(4), 0.5 * upto(7), lead);
        one.effect += Time(upto(1000));
        commands.push_back(one);
      }
      rig.push(commands);
      all.insert(all.end(), commands.begin(), commands.end());
      rig.run_to(batch * 200 + upto(200));
    }
    rig.run_to(3000);
    const std::vector<Write> expected = expected_writes(all);
    fail_unless(padded(rig.writes()) == expected, "seed %u", seed);
    const TactorScheduler::Counters counters = rig.scheduler->counters();
    ck_assert_uint_eq(counters.issued + counters.coalesced, all.size());
    ck_assert_uint_eq(counters.late, 0);
    ck_assert_int_eq(counters.error.max().count(), 0);
    rig.scheduler->stop();
    Volts last(4, 0.0);
    for (const tactor::IssuedCommand &issued : tactor::read_command_trace(rig.trace_path)) {
      if (issued.issued > milliseconds(2500))
        continue; // the stop
      fail_unless(issued.issued == issued.command.due());
      fail_unless(std::ranges::find(all, issued.command) != all.end());
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_an_earlier_command_cuts_the_sleep_short)
{
  Rig rig;
  rig.push({ command(500, 0, 1.0) }, milliseconds(700));
  fail_unless(rig.asleep() == milliseconds(500));
  rig.push({ command(400, 0, 2.0, 150) }, milliseconds(800));
  rig.run_to(249);
  fail_unless(rig.writes().empty());
  rig.run_to(600);
  fail_unless(
      rig.writes()
      == (std::vector<Write>{ { milliseconds(250), { 2.0 } }, { milliseconds(500), { 1.0 } } }));
  fail_unless(rig.asleep() == milliseconds(800));
}
GST_END_TEST;

GST_START_TEST(test_stale_commands_coalesce)
{
  Rig rig;
  rig.push({ command(100, 0, 1.0), command(150, 1, 1.5, 20), command(200, 0, 2.0),
             command(900, 0, 3.0) });
  rig.jump_to(milliseconds(205));
  fail_unless(rig.asleep() == milliseconds(900));
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(205), { 2.0, 1.5 } } }));
  const TactorScheduler::Counters counters = rig.scheduler->counters();
  ck_assert_uint_eq(counters.issued, 2);
  ck_assert_uint_eq(counters.coalesced, 1);
  ck_assert_uint_eq(counters.late, 1); // 75 ms; 5 ms are within the tolerance
  fail_unless(counters.error.min() == milliseconds(5) && counters.error.max() == milliseconds(75));
  fail_unless(rig.host.shorts()
              == (std::vector<std::pair<Time, Time>>{ { milliseconds(20), milliseconds(75) } }));
}
GST_END_TEST;

/// As in a pipeline that pauses: clock time goes on, running time does not.
GST_START_TEST(test_pause_and_resume)
{
  Rig rig;
  rig.push({ command(100, 0, 2.0), command(120, 2, 1.0), command(400, 0, 3.0) });
  rig.run_to(150);
  rig.scheduler->pause();
  fail_unless(rig.board.is_silent());
  ck_assert_uint_eq(rig.writes().size(), 3);
  fail_unless(rig.writes().back().now == milliseconds(150));
  rig.offset += milliseconds(1000);
  rig.host.set(GST_CLOCK(rig.clock), rig.offset);
  gst_test_clock_advance_time(rig.clock, GST_SECOND);
  rig.scheduler->timing_changed();
  rig.scheduler->pause(); // once more: nothing else happens
  ck_assert_uint_eq(rig.writes().size(), 3);

  rig.scheduler->play();
  fail_unless(rig.writes().back() == (Write{ milliseconds(150), { 2.0, 0.0, 1.0 } }));
  rig.scheduler->play();
  ck_assert_uint_eq(rig.writes().size(), 4);
  rig.run_to(500);
  fail_unless(rig.writes().back() == (Write{ milliseconds(400), { 3.0, 0.0, 1.0 } }));
  ck_assert_uint_eq(rig.scheduler->counters().issued, 3);
  ck_assert_uint_eq(rig.scheduler->counters().dropped, 0);
}
GST_END_TEST;

GST_START_TEST(test_nothing_is_written_before_play)
{
  Rig rig(false);
  rig.push({ command(0, 0, 2.0), command(50, 0, 1.0) });
  gst_test_clock_advance_time(rig.clock, 60 * GST_MSECOND);
  rig.scheduler->pause();
  fail_unless(rig.writes().empty());
  rig.scheduler->play();
  rig.asleep();
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(60), { 1.0 } } }));
}
GST_END_TEST;

GST_START_TEST(test_flush_forgets)
{
  Rig rig;
  rig.push({ command(100, 0, 2.0), command(400, 0, 3.0), command(500, 1, 3.0) });
  rig.run_to(150);
  rig.scheduler->flush();
  fail_unless(rig.board.is_silent());
  ck_assert_uint_eq(rig.scheduler->counters().dropped, 2);
  rig.scheduler->pause();
  rig.scheduler->play();
  fail_unless(rig.board.is_silent());
  rig.push({ command(600, 1, 1.0) });
  fail_unless(rig.asleep() == milliseconds(600)); // what was to expire is forgotten too
  rig.run_to(650);
  ck_assert_uint_eq(rig.writes().size(), 3);
  fail_unless(rig.writes().back() == (Write{ milliseconds(600), { 0.0, 1.0 } }));
}
GST_END_TEST;

GST_START_TEST(test_stop)
{
  Rig rig;
  rig.push({ command(100, 3, 2.0), command(400, 0, 3.0) });
  rig.run_to(150);
  rig.scheduler->stop();
  fail_unless(silent(rig.writes().back().volts));
  fail_if(rig.board.get(&Board::open));
  fail_unless(rig.board.get(&Board::destroyed));
  ck_assert_uint_eq(rig.scheduler->counters().dropped, 1);
  // After the end, and before a new beginning, nothing is there to wait for.
  rig.scheduler->stop();
  rig.scheduler->play();
  rig.scheduler->flush();
  rig.scheduler->set_muted(false);
  rig.scheduler->pause();
  fail_if(rig.scheduler->trace_failed());

  rig.start();
  rig.scheduler->play();
  ck_assert_uint_eq(rig.scheduler->counters().issued, 0);
  rig.push({ command(200, 0, 1.0) });
  rig.run_to(250);
  fail_unless(rig.writes().back() == (Write{ milliseconds(200), { 1.0 } }));
  // Rig's end destroys the scheduler while it plays, and looks whether the motors stand.
}
GST_END_TEST;

/// Silence asked for inside a write comes after what is being written, and is there when the call returns.
GST_START_TEST(test_silence_during_a_write)
{
  const std::vector<std::function<void(TactorScheduler &)>> ways{
    [](TactorScheduler &s) { s.pause(); },
    [](TactorScheduler &s) { s.flush(); },
    [](TactorScheduler &s) { s.stop(); },
    [](TactorScheduler &s) { s.set_muted(true); },
  };
  for (const auto &way : ways) {
    Rig rig;
    during_a_write(rig, [&] {
      way(*rig.scheduler);
      fail_unless(rig.board.is_silent());
    });
    const std::vector<Write> writes = rig.writes();
    ck_assert_uint_eq(writes.size(), 2);
    fail_unless(writes[0].volts == (Volts{ 0.0, 2.0 }));
    fail_unless(silent(writes[1].volts));
  }
}
GST_END_TEST;

/// Who asks for silence while the board is told of what others asked for before, is let go after the
/// zeros and not already after that.
GST_START_TEST(test_silence_comes_before_the_return)
{
  for (int round = 0; round < 10; round++) {
    Rig rig;
    rig.push({ command(100, 1, 2.0) });
    rig.scheduler->set_muted(true);
    rig.run_to(150);
    rig.board.set(&Board::hold, true);
    std::thread unmute([&] { rig.scheduler->set_muted(false); });
    rig.board.wait_until_held();
    std::atomic<bool> paused{ false };
    std::thread pause([&] {
      rig.scheduler->pause();
      paused = true;
    });
    for (int i = 0; i < 1000; i++)
      std::this_thread::yield(); // so that it waits: what follows has to be right in any case
    rig.board.set(&Board::passes, 1);
    rig.board.wait_until_held(); // in the write of zeros
    for (int i = 0; i < 1000; i++)
      std::this_thread::yield();
    fail_if(paused);
    rig.board.set(&Board::hold, false);
    pause.join();
    unmute.join();
    fail_unless(rig.board.is_silent());
  }
}
GST_END_TEST;

GST_START_TEST(test_mute_follows_silently)
{
  Rig rig;
  rig.push({ command(100, 0, 2.0), command(200, 1, 1.0), command(300, 0, 0.5) });
  rig.run_to(150);
  rig.scheduler->set_muted(true);
  fail_unless(rig.writes().back() == (Write{ milliseconds(150), { 0.0 } }));
  rig.run_to(250);
  ck_assert_uint_eq(rig.writes().size(), 2);
  ck_assert_uint_eq(rig.scheduler->counters().issued, 2);
  rig.scheduler->pause();
  rig.scheduler->play();
  fail_unless(rig.board.is_silent());
  rig.scheduler->set_muted(false);
  fail_unless(rig.writes().back() == (Write{ milliseconds(250), { 2.0, 1.0 } }));
  rig.run_to(350);
  fail_unless(rig.writes().back() == (Write{ milliseconds(300), { 0.5, 1.0 } }));
}
GST_END_TEST;

GST_START_TEST(test_starved)
{
  Rig rig;
  rig.push({ command(100, 0, 2.0), command(100, 2, 1.0), command(110, 2, 0.0) }, milliseconds(500));
  rig.run_to(200);
  rig.push({}, milliseconds(700)); // a map that changes nothing
  rig.jump_to(milliseconds(500));
  fail_unless(rig.asleep() == milliseconds(700));
  fail_if(rig.scheduler->take_starved());
  rig.jump_to(milliseconds(700));
  while (!rig.scheduler->take_starved())
    std::this_thread::yield();
  fail_if(rig.scheduler->take_starved());
  rig.push({ command(900, 1, 1.0), command(1000, 1, 0.0) }, milliseconds(1500));
  rig.run_to(1100);
  fail_unless(rig.writes()[2] == (Write{ milliseconds(700), { 0.0, 0.0, 0.0 } }));
  fail_unless(rig.writes()[3] == (Write{ milliseconds(900), { 0.0, 1.0, 0.0 } }));
  // Motors that stand anyway do not starve.
  rig.jump_to(milliseconds(1500));
  rig.push({ command(1600, 1, 1.0) }, milliseconds(1800));
  rig.run_to(1700);
  fail_if(rig.scheduler->take_starved());
  ck_assert_uint_eq(rig.scheduler->counters().starved, 1);
  // A flush begins anew: whoever plans has begun anew, too.
  rig.jump_to(milliseconds(1800));
  while (rig.scheduler->counters().starved != 2)
    std::this_thread::yield();
  rig.scheduler->flush();
  fail_if(rig.scheduler->take_starved());
}
GST_END_TEST;

GST_START_TEST(test_offset_and_clock_change)
{
  Rig rig;
  rig.push({ command(300, 0, 1.0), command(400, 0, 2.0), command(500, 0, 3.0) });
  rig.run_to(100);
  rig.offset += milliseconds(50);
  rig.host.set(GST_CLOCK(rig.clock), rig.offset);
  rig.scheduler->timing_changed();
  rig.run_to(350); // running time 50 was come back to: nothing was due
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(300), { 1.0 } } }));

  // Another clock, at a time of its own, shows running time 360.
  GstTestClock *other = GST_TEST_CLOCK(gst_test_clock_new_with_start_time(77 * GST_SECOND));
  std::swap(rig.clock, other);
  rig.offset = std::chrono::seconds(77) - milliseconds(360);
  rig.host.set(GST_CLOCK(rig.clock), rig.offset);
  rig.scheduler->timing_changed();
  rig.run_to(450);
  fail_unless(rig.writes().back() == (Write{ milliseconds(400), { 2.0 } }));
  ck_assert_uint_eq(gst_test_clock_peek_id_count(other), 0);
  rig.scheduler->pause();
  rig.scheduler->play();
  rig.run_to(550);
  fail_unless(rig.writes().back() == (Write{ milliseconds(500), { 3.0 } }));
  gst_object_unref(other);
}
GST_END_TEST;

/// A change that comes just after the scheduler has read the timing, and before it sleeps, is not missed.
GST_START_TEST(test_change_between_reading_and_sleeping)
{
  Rig rig;
  rig.push({}, std::chrono::seconds(9));
  rig.asleep();
  std::atomic<bool> changed{ false };
  rig.host.set(GST_CLOCK(rig.clock), rig.offset, [&] {
    // On the scheduler's thread, which holds no lock here: as if another thread came in between.
    rig.host.set(GST_CLOCK(rig.clock), Time(0));
    rig.scheduler->timing_changed();
    changed = true;
  });
  rig.push({ command(8000, 0, 1.0) });
  while (!changed)
    std::this_thread::yield();
  rig.offset = Time(0);
  fail_unless(rig.asleep() == milliseconds(8000));
}
GST_END_TEST;

GST_START_TEST(test_no_clock_and_immediate)
{
  for (const bool clock : { false, true }) {
    Rig rig;
    rig.push({ command(100, 0, 1.0) });
    rig.asleep();
    if (clock) {
      rig.scheduler->set_immediate(true);
    } else {
      rig.host.set(nullptr, rig.offset);
      rig.scheduler->timing_changed();
    }
    while (rig.scheduler->counters().issued < 1)
      std::this_thread::yield();
    rig.push({ command(900, 1, 2.0), command(990, 1, 3.0) });
    rig.push({});
    while (rig.scheduler->counters().issued + rig.scheduler->counters().coalesced < 3)
      std::this_thread::yield();
    rig.scheduler->set_muted(false); // returns after what is being written
    fail_unless(rig.writes().back().volts == (Volts{ 1.0, 3.0 }));
    ck_assert_uint_eq(rig.scheduler->counters().error.count(), 0);
    rig.scheduler->pause();
    fail_unless(rig.board.is_silent());
    rig.push({ command(950, 0, 2.0) });
    rig.scheduler->set_immediate(false);
    rig.host.set(GST_CLOCK(rig.clock), rig.offset);
    rig.scheduler->play();
    rig.run_to(1000);
    fail_unless(rig.writes().back() == (Write{ milliseconds(950), { 2.0, 3.0 } }));
  }
}
GST_END_TEST;

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
        for (unsigned n = random() % 5; n > 0; n--)
          commands.push_back(
              command(ms_now() + static_cast<int>(random() % 60), static_cast<int>(random() % 4),
                      0.5 * static_cast<double>(random() % 4), static_cast<int>(random() % 60)));
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
        switch (random() % 4) {
        case 0:
          rig.scheduler->flush();
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
tactorscheduler_suite(void)
{
  Suite *suite = suite_create("tactorscheduler");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_test(cases, test_issued_exactly_when_due);
  tcase_add_test(cases, test_an_earlier_command_cuts_the_sleep_short);
  tcase_add_test(cases, test_stale_commands_coalesce);
  tcase_add_test(cases, test_pause_and_resume);
  tcase_add_test(cases, test_nothing_is_written_before_play);
  tcase_add_test(cases, test_flush_forgets);
  tcase_add_test(cases, test_stop);
  tcase_add_test(cases, test_silence_during_a_write);
  tcase_add_test(cases, test_silence_comes_before_the_return);
  tcase_add_test(cases, test_mute_follows_silently);
  tcase_add_test(cases, test_starved);
  tcase_add_test(cases, test_offset_and_clock_change);
  tcase_add_test(cases, test_change_between_reading_and_sleeping);
  tcase_add_test(cases, test_no_clock_and_immediate);
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

GST_CHECK_MAIN(tactorscheduler);
