// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The scheduler's own protection of motors and skin: commands run out, the first vibration starts
// softly.
#include "scheduler_rig.h"

#include <thread>

#include "support/check_tests.h"

namespace {

Command
until(Command one, int ms)
{
  one.until = milliseconds(ms);
  return one;
}

/// Times in ms and volts of tactor 0, for each write.
std::vector<std::pair<int, double>>
writes_of_first(SchedulerRig &rig)
{
  std::vector<std::pair<int, double>> all;
  for (const Write &write : rig.writes())
    all.emplace_back(static_cast<int>(write.now / milliseconds(1)), write.volts[0]);
  return all;
}

/// The steps of a soft start: up to five of 0.6 V, until `volts` is reached.
std::vector<std::pair<int, double>>
soft(int ms, double volts)
{
  std::vector<std::pair<int, double>> all;
  for (int step = 1; step <= 5; step++)
    if (all.empty() || all.back().second < volts)
      all.emplace_back(ms + 20 * (step - 1), std::min(0.6 * step, volts));
  return all;
}

void
assert_writes(SchedulerRig &rig, const std::vector<std::pair<int, double>> &expected)
{
  const auto writes = writes_of_first(rig);
  ck_assert_uint_eq(writes.size(), expected.size());
  for (std::size_t i = 0; i < writes.size(); i++) {
    ck_assert_int_eq(writes[i].first, expected[i].first);
    fail_unless(std::abs(writes[i].second - expected[i].second) < 1e-9, "%g V at %d ms",
                writes[i].second, writes[i].first);
  }
}

} // namespace

/// A command's own end stops the motor, without a map or a command.
CHECK_TEST(test_command_runs_out)
{
  SchedulerRig rig;
  rig.push({ until(command(100, 0, 2.0), 300), until(command(100, 1, 1.0), 400) });
  rig.run_to(100);
  fail_unless(rig.asleep() == milliseconds(300));
  rig.run_to(350);
  rig.push({ until(command(380, 1, 1.5), 500) });
  rig.run_to(600);
  const std::vector<Write> expected{ { milliseconds(100), { 2.0, 1.0 } },
                                     { milliseconds(300), { 0.0, 1.0 } },
                                     { milliseconds(380), { 0.0, 1.5 } },
                                     { milliseconds(500), { 0.0, 0.0 } } };
  fail_unless(rig.writes() == expected);
  ck_assert_uint_eq(rig.scheduler->counters().issued, 5);
  ck_assert_uint_eq(rig.scheduler->counters().starved, 0);
  fail_unless(rig.scheduler->counters().error.max() == Time(0));
}

/// When no map arrives, motors stop before their commands run out.
CHECK_TEST(test_starves_before_it_runs_out)
{
  SchedulerRig rig;
  rig.push({ until(command(100, 0, 2.0), 900) }, milliseconds(500));
  rig.run_to(100);
  fail_unless(rig.asleep() == milliseconds(500));
  rig.jump_to(milliseconds(500));
  while (rig.scheduler->counters().starved == 0)
    std::this_thread::yield();
  fail_unless(rig.scheduler->take_starved() == milliseconds(500));
}

/// A pause does not count: the rest of the command's time follows the resume.
CHECK_TEST(test_pause_and_run_out)
{
  SchedulerRig rig;
  rig.push({ until(command(100, 0, 2.0), 300) });
  rig.run_to(200);
  rig.scheduler->pause();
  gst_test_clock_set_time(rig.clock, 15 * GST_SECOND);
  rig.host.set(GST_CLOCK(rig.clock), std::chrono::seconds(15) - milliseconds(200));
  rig.offset = std::chrono::seconds(15) - milliseconds(200);
  rig.scheduler->play();
  fail_unless(rig.asleep() == milliseconds(300));
  rig.run_to(400);
  ck_assert_uint_eq(rig.writes().size(), 4);
  fail_unless(rig.writes()[2] == (Write{ milliseconds(200), { 2.0 } }));
  fail_unless(rig.writes()[3] == (Write{ milliseconds(300), { 0.0 } }));
}

/// Without the clock a command runs out when the film's time gets there, not at once.
CHECK_TEST(test_runs_out_without_the_clock)
{
  SchedulerRig rig(false);
  rig.scheduler->set_immediate(true);
  rig.scheduler->play();
  rig.push({ until(command(100, 0, 2.0), 300) });
  fail_unless(rig.board.get(&Board::volts) == Volts{ 2.0 });
  rig.push({ command(250, 1, 1.0) });
  fail_unless(rig.board.get(&Board::volts) == (Volts{ 2.0, 1.0 }));
  rig.push({ command(400, 1, 0.0) });
  fail_unless(rig.writes()[2] == (Write{ milliseconds(300), { 0.0, 1.0 } }));
  fail_unless(rig.writes()[3] == (Write{ milliseconds(400), { 0.0, 0.0 } }));
  rig.scheduler->drain(rig.scheduler->interruptions());
}

/// The first vibration after the start is soft, the second is not. Without the clock none is.
CHECK_TEST(test_soft_start)
{
  SchedulerRig rig;
  rig.scheduler->set_ramp_in(milliseconds(100));
  rig.push({ command(100, 0, 3.0), command(400, 0, 0.0), command(500, 0, 3.0) });
  rig.run_to(600);
  auto expected = soft(100, 3.0);
  expected.emplace_back(400, 0.0);
  expected.emplace_back(500, 3.0);
  assert_writes(rig, expected);
  ck_assert_uint_eq(rig.scheduler->counters().ramps, 1);

  SchedulerRig untimed(false);
  untimed.scheduler->set_ramp_in(milliseconds(100));
  untimed.scheduler->set_immediate(true);
  untimed.scheduler->play();
  untimed.push({ command(100, 0, 3.0) });
  assert_writes(untimed, { { 100, 3.0 } });
  ck_assert_uint_eq(untimed.scheduler->counters().ramps, 0);
}

/// A pause, a flush and mute arm another soft start. A low level is reached earlier, and a level
/// that changes meanwhile is limited, too.
CHECK_TEST(test_soft_again)
{
  SchedulerRig rig;
  rig.scheduler->set_ramp_in(milliseconds(100));
  rig.push({ command(0, 0, 1.0), command(30, 0, 2.0) });
  rig.run_to(200);
  auto expected
      = std::vector<std::pair<int, double>>{ { 0, 0.6 }, { 20, 1.0 }, { 40, 1.8 }, { 60, 2.0 } };
  // At 30 ms the limit is still 1.2 V.
  expected.insert(expected.begin() + 2, { 30, 1.2 });
  assert_writes(rig, expected);

  rig.scheduler->pause();
  rig.scheduler->play();
  rig.run_to(400);
  expected.emplace_back(200, 0.0);
  for (const auto &step : soft(200, 2.0))
    expected.push_back(step);
  assert_writes(rig, expected);

  rig.scheduler->set_muted(true);
  rig.scheduler->set_muted(false);
  rig.run_to(600);
  expected.emplace_back(400, 0.0);
  for (const auto &step : soft(400, 2.0))
    expected.push_back(step);
  assert_writes(rig, expected);

  fail_unless(rig.scheduler->flush() == milliseconds(600));
  rig.push({ command(700, 0, 3.0) });
  rig.run_to(900);
  expected.emplace_back(600, 0.0);
  for (const auto &step : soft(700, 3.0))
    expected.push_back(step);
  assert_writes(rig, expected);
  ck_assert_uint_eq(rig.scheduler->counters().ramps, 4);
}

/// On a line that takes 15 ms per level, two levels take 30 ms, and so do the steps from the next
/// one on. The flush's zero is the first write of the second ramp.
CHECK_TEST(test_soft_start_on_a_slow_line)
{
  SchedulerRig rig(false);
  rig.scheduler->stop();
  rig.board.set(&Board::line, tactor::LineTime({ 1, 1, 1, 1 }, milliseconds(15)));
  rig.start();
  rig.scheduler->set_ramp_in(milliseconds(100));
  rig.scheduler->play();
  rig.push({ command(100, 0, 3.0), command(100, 1, 3.0) });
  rig.run_to(300);
  std::vector<std::pair<int, double>> expected{
    { 100, 0.9 }, { 130, 1.8 }, { 160, 2.7 }, { 190, 3.0 }
  };
  assert_writes(rig, expected);

  rig.scheduler->flush();
  rig.push({ command(400, 0, 3.0), command(410, 1, 3.0) });
  rig.run_to(600);
  expected.insert(
      expected.end(),
      { { 300, 0.0 }, { 400, 0.6 }, { 410, 0.6 }, { 420, 1.5 }, { 450, 2.4 }, { 480, 3.0 } });
  assert_writes(rig, expected);
}

/// A lost board is at zero until it returns, and starts softly, too. A pause during a soft start
/// ends it.
CHECK_TEST(test_soft_after_faults)
{
  SchedulerRig rig;
  rig.scheduler->set_ramp_in(milliseconds(100));
  rig.push({ command(0, 0, 3.0) });
  rig.run_to(30);
  rig.scheduler->set_board_away(true);
  rig.board.wait_until([&] { return silent(rig.board.volts); });
  rig.run_to(1040);
  rig.scheduler->set_board_away(false);
  rig.board.wait_until([&] { return !silent(rig.board.volts); });
  rig.run_to(1200);
  std::vector<std::pair<int, double>> expected{ { 0, 0.6 }, { 20, 1.2 }, { 30, 0.0 } };
  for (const auto &step : soft(1040, 3.0))
    expected.push_back(step);
  assert_writes(rig, expected);
  ck_assert_uint_eq(rig.scheduler->counters().ramps, 2);
  rig.scheduler->pause();
  rig.scheduler->play();
  rig.run_to(1250);
  rig.scheduler->pause();
  expected.insert(expected.end(),
                  { { 1200, 0.0 }, { 1200, 0.6 }, { 1220, 1.2 }, { 1240, 1.8 }, { 1250, 0.0 } });
  assert_writes(rig, expected);
}

CHECK_MAIN(tactorscheduler_limits)
