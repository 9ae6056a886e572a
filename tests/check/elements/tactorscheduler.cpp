// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's scheduler: exact times, silence, and changes of the clock.
#include "scheduler_rig.h"

#include <chrono>
#include <latch>
#include <map>
#include <random>
#include <stop_token>
#include <thread>

#include <gst/audio/gstaudioclock.h>

#include "support/check_tests.h"

namespace {

/// The expected writes if each command is a write of its own: sorted by due time. Of commands for
/// the same tactor and time the last wins. Writes without a change are left out.
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

/// Writes may omit trailing tactors that were never on. This adds their zeros.
std::vector<Write>
padded(std::vector<Write> writes)
{
  for (Write &write : writes)
    write.volts.resize(4, 0.0);
  return writes;
}

/// Runs work() during a write of nonzero volts, which ends only afterwards, and waits for both.
void
during_a_write(SchedulerRig &rig, const std::function<void()> &work)
{
  rig.push({ command(100, 1, 2.0) });
  rig.run_to(50);
  rig.board.set(&Board::hold, true);
  rig.jump_to(milliseconds(100));
  rig.board.wait_until_held();
  std::thread other(work);
  std::this_thread::yield(); // either order is valid
  rig.board.set(&Board::hold, false);
  other.join();
}

} // namespace

/// Commands pushed in any order are written and traced at their due time, to the nanosecond.
CHECK_TEST(test_issued_exactly_when_due)
{
  for (unsigned seed = 1; seed <= 20; seed++) {
    SchedulerRig rig;
    std::mt19937 random(seed);
    const auto below = [&](int n) {
      return static_cast<int>(random() % static_cast<unsigned>(n));
    };
    std::vector<Command> all;
    for (int batch = 0; batch < 10; batch++) {
      std::vector<Command> commands;
      for (int i = below(8); i > 0; i--) {
        const int lead = below(180);
        Command one = command(batch * 200 + lead + 1 + below(199), below(4), 0.5 * below(7), lead);
        one.effect += Time(below(1000));
        commands.push_back(one);
      }
      rig.push(commands);
      all.insert(all.end(), commands.begin(), commands.end());
      rig.run_to(batch * 200 + below(200));
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
    for (const tactor::IssuedCommand &issued :
         unwrap(tactor::read_command_trace(rig.trace_file.path))) {
      if (issued.issued > milliseconds(2500))
        continue; // of the stop
      fail_unless(issued.issued == issued.command.due());
      fail_unless(std::ranges::find(all, issued.command) != all.end());
    }
  }
}

CHECK_TEST(test_an_earlier_command_cuts_the_sleep_short)
{
  SchedulerRig rig;
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

CHECK_TEST(test_stale_commands_coalesce)
{
  SchedulerRig rig;
  rig.push({ command(100, 0, 1.0), command(150, 1, 1.5, 20), command(200, 0, 2.0),
             command(900, 0, 3.0) });
  rig.jump_to(milliseconds(205));
  fail_unless(rig.asleep() == milliseconds(900));
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(205), { 2.0, 1.5 } } }));
  const TactorScheduler::Counters counters = rig.scheduler->counters();
  ck_assert_uint_eq(counters.issued, 2);
  ck_assert_uint_eq(counters.coalesced, 1);
  ck_assert_uint_eq(counters.late, 1); // by 75 ms; the other is 5 ms late, which is tolerated
  fail_unless(counters.error.min() == milliseconds(5) && counters.error.max() == milliseconds(75));
  const auto latest = rig.scheduler->take_short_lead();
  fail_unless(latest && latest->lead == milliseconds(20) && latest->late == milliseconds(75));
  fail_if(rig.scheduler->take_short_lead());
}

/// Like a pipeline that pauses: clock time continues, running time does not.
CHECK_TEST(test_pause_and_resume)
{
  SchedulerRig rig;
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
  rig.scheduler->pause(); // again, without effect
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

CHECK_TEST(test_nothing_is_written_before_play)
{
  SchedulerRig rig(false);
  rig.push({ command(0, 0, 2.0), command(50, 0, 1.0) });
  gst_test_clock_advance_time(rig.clock, 60 * GST_MSECOND);
  rig.scheduler->pause();
  fail_unless(rig.writes().empty());
  rig.scheduler->play();
  rig.asleep();
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(60), { 1.0 } } }));
}

CHECK_TEST(test_flush_forgets)
{
  SchedulerRig rig;
  rig.push({ command(100, 0, 2.0), command(400, 0, 3.0), command(500, 1, 3.0) });
  rig.run_to(150);
  rig.scheduler->flush();
  fail_unless(rig.board.is_silent());
  ck_assert_uint_eq(rig.scheduler->counters().dropped, 2);
  rig.scheduler->pause();
  rig.scheduler->play();
  fail_unless(rig.board.is_silent());
  rig.push({ command(600, 1, 1.0) });
  fail_unless(rig.asleep() == milliseconds(600)); // expiry times are forgotten, too
  rig.run_to(650);
  ck_assert_uint_eq(rig.writes().size(), 3);
  fail_unless(rig.writes().back() == (Write{ milliseconds(600), { 0.0, 1.0 } }));
}

CHECK_TEST(test_stop)
{
  SchedulerRig rig;
  rig.push({ command(100, 3, 2.0), command(400, 0, 3.0) });
  rig.run_to(150);
  rig.scheduler->stop();
  fail_unless(silent(rig.writes().back().volts));
  fail_if(rig.board.get(&Board::open));
  fail_unless(rig.board.get(&Board::destroyed));
  ck_assert_uint_eq(rig.scheduler->counters().dropped, 1);
  // Stopped, it waits for nothing.
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
  // ~SchedulerRig destroys the scheduler while it plays and checks that motors are off.
}

/// Silence requested during a write follows that write, and is complete when the call returns.
CHECK_TEST(test_silence_during_a_write)
{
  const std::vector<std::function<void(TactorScheduler &)>> ways{
    [](TactorScheduler &s) { s.pause(); },
    [](TactorScheduler &s) { s.flush(); },
    [](TactorScheduler &s) { s.stop(); },
    [](TactorScheduler &s) { s.set_muted(true); },
  };
  for (const auto &way : ways) {
    SchedulerRig rig;
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

/// A request for silence during an earlier request's write returns after the zeros, not after that
/// write.
CHECK_TEST(test_silence_comes_before_the_return)
{
  for (int round = 0; round < 10; round++) {
    SchedulerRig rig;
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
      std::this_thread::yield(); // gives it time to wait; any order is valid
    rig.board.set(&Board::passes, 1);
    rig.board.wait_until_held(); // the write of zeros
    for (int i = 0; i < 1000; i++)
      std::this_thread::yield();
    fail_if(paused);
    rig.board.set(&Board::hold, false);
    pause.join();
    unmute.join();
    fail_unless(rig.board.is_silent());
  }
}

CHECK_TEST(test_mute_follows_silently)
{
  SchedulerRig rig;
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

CHECK_TEST(test_starved)
{
  SchedulerRig rig;
  rig.push({ command(100, 0, 2.0), command(100, 2, 1.0), command(110, 2, 0.0) }, milliseconds(500));
  rig.run_to(200);
  rig.push({}, milliseconds(700)); // a map without changes
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
  // Motors at rest do not count as starved.
  rig.jump_to(milliseconds(1500));
  rig.push({ command(1600, 1, 1.0) }, milliseconds(1800));
  rig.run_to(1700);
  fail_if(rig.scheduler->take_starved());
  ck_assert_uint_eq(rig.scheduler->counters().starved, 1);
  // A flush resets it, as the planner starts anew, too.
  rig.jump_to(milliseconds(1800));
  while (rig.scheduler->counters().starved != 2)
    std::this_thread::yield();
  rig.scheduler->flush();
  fail_if(rig.scheduler->take_starved());
}

/// A film that is seconds late, as after a suspend, stays silent while it catches up: no motor
/// starts for frames shown long ago.
CHECK_TEST(test_stale_commands_are_dropped)
{
  SchedulerRig rig;
  rig.push({ command(100, 0, 2.0) }, milliseconds(1200));
  rig.run_to(200);
  rig.push({ command(2000, 1, 1.0), command(4000, 2, 1.0) }, milliseconds(5000));
  // The clock jumps past the end of the film.
  rig.jump_to(std::chrono::hours(1));
  while (rig.scheduler->counters().starved != 1)
    std::this_thread::yield();
  fail_unless(rig.scheduler->take_starved() == std::chrono::hours(1));
  const std::size_t writes = rig.writes().size();
  fail_unless(rig.writes().back() == (Write{ std::chrono::hours(1), { 0.0 } }));
  // Maps from before the jump keep coming.
  for (int i = 0; i < 50; i++) {
    rig.push({ command(5000 + 200 * i, 1, 2.0, 60) }, milliseconds(6033 + 200 * i));
    rig.scheduler->play(); // returns after one turn of the loop
  }
  fail_unless(rig.board.is_silent());
  ck_assert_uint_eq(rig.writes().size(), writes);
  ck_assert_uint_eq(rig.scheduler->counters().dropped, 52);
  ck_assert_uint_eq(rig.scheduler->counters().issued, 1);
  ck_assert_uint_eq(rig.scheduler->counters().starved, 1);
  ck_assert_uint_eq(rig.scheduler->counters().expired, 52);
  fail_unless(rig.scheduler->take_short_lead().has_value());
  // Once it has caught up, motors play again.
  const int hour = 3'600'000;
  rig.push({ command(hour + 500, 1, 1.0) }, milliseconds(hour + 2000));
  rig.run_to(hour + 600);
  fail_unless(rig.board.get(&Board::volts) == (Volts{ 0.0, 1.0 }));
}

/// An interruption may end before drain() begins or wakes up. It ends drain() nevertheless.
/// GstBaseSink's are that short when it need not wait for a lock.
CHECK_TEST(test_interruptions_in_passing)
{
  SchedulerRig rig;
  rig.push({ command(100, 0, 2.0) });
  const auto interrupt = [&] {
    rig.scheduler->interrupt(true);
    rig.scheduler->interrupt(false);
  };
  const std::uint64_t before = rig.scheduler->interruptions();
  interrupt();
  rig.scheduler->drain(before);
  // Has begun when the count is read.
  rig.scheduler->interrupt(true);
  const std::uint64_t during = rig.scheduler->interruptions();
  rig.scheduler->interrupt(false);
  rig.scheduler->drain(during);
  // During the wait.
  const std::uint64_t now = rig.scheduler->interruptions();
  std::thread drain([&] { rig.scheduler->drain(now); });
  interrupt();
  drain.join();
  fail_unless(rig.board.is_silent());
}

/// While a board does not answer, only wait_until_open() blocks, and a stop ends it.
CHECK_TEST(test_stopped_while_opening)
{
  using Outcome = TactorScheduler::Outcome;
  Host host;
  TactorScheduler scheduler(host.calls());
  std::atomic<bool> stopped = false;
  const auto wait_for_stop = [&](const std::stop_token &stop) {
    std::latch requested(1);
    const std::stop_callback count_down(stop, [&] { requested.count_down(); });
    requested.wait();
    stopped = true;
    return tl::unexpected(tactor::DriverError{ tactor::DriverError::Kind::failed, "stopped" });
  };
  for (int time = 0; time < 2; time++) {
    stopped = false;
    unwrap(scheduler.start(wait_for_stop, 3.0));
    scheduler.play();
    scheduler.pause();
    scheduler.flush();
    scheduler.set_muted(true);
    scheduler.timing_changed();
    const std::uint64_t before = scheduler.interruptions();
    Outcome outcome = Outcome::open;
    std::thread streaming([&] { outcome = scheduler.wait_until_open(before); });
    scheduler.interrupt(true);
    scheduler.interrupt(false);
    streaming.join();
    fail_unless(outcome == Outcome::interrupted);
    // Without an interruption, the stop ends the wait.
    const std::uint64_t now = scheduler.interruptions();
    std::thread another([&] { outcome = scheduler.wait_until_open(now); });
    scheduler.stop();
    another.join();
    fail_unless(stopped);
    fail_unless(outcome == Outcome::stopped);
    fail_if(scheduler.failed());
  }
  fail_unless(host.refusals().empty());
}

/// A failure to open is reported once, before the waiting call returns.
CHECK_TEST(test_cannot_be_opened)
{
  using Outcome = TactorScheduler::Outcome;
  Host host;
  TactorScheduler scheduler(host.calls());
  unwrap(scheduler.start(
      [](const std::stop_token &) {
        return tl::unexpected(tactor::DriverError{ tactor::DriverError::Kind::busy, "taken" });
      },
      3.0));
  fail_unless(scheduler.wait_until_open(scheduler.interruptions()) == Outcome::failed);
  fail_unless(scheduler.failed());
  fail_unless(host.refusals() == std::vector<std::string>{ "taken" });
  scheduler.play();
  scheduler.push(std::vector{ command(0, 0, 1.0) }, kForever);
  scheduler.drain(scheduler.interruptions());
  scheduler.stop();
  fail_unless_equals_int(host.failed, 0);
}

CHECK_TEST(test_offset_and_clock_change)
{
  SchedulerRig rig;
  rig.push({ command(300, 0, 1.0), command(400, 0, 2.0), command(500, 0, 3.0) });
  rig.run_to(100);
  rig.offset += milliseconds(50);
  rig.host.set(GST_CLOCK(rig.clock), rig.offset);
  rig.scheduler->timing_changed();
  rig.run_to(350); // running time went back to 50, where nothing was due
  fail_unless(rig.writes() == (std::vector<Write>{ { milliseconds(300), { 1.0 } } }));

  // Another clock with another time shows running time 360.
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

/// A change between the scheduler's reading of the timing and its sleep is not missed.
CHECK_TEST(test_change_between_reading_and_sleeping)
{
  SchedulerRig rig;
  rig.push({}, std::chrono::seconds(9));
  rig.asleep();
  std::atomic<bool> changed{ false };
  rig.host.set(GST_CLOCK(rig.clock), rig.offset, [&] {
    // On the scheduler's thread, which holds no lock here: as if another thread intervened.
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

CHECK_TEST(test_no_clock_and_immediate)
{
  for (const bool clock : { false, true }) {
    SchedulerRig rig;
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
    rig.scheduler->set_muted(false); // returns after the write in progress
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

/// A sound server's clock, which stands still and notes when it is read.
struct SoundClock
{
  std::mutex mutex;
  std::condition_variable was_read;
  std::vector<std::chrono::steady_clock::time_point> reads;

  static GstClockTime read(GstClock *, gpointer data)
  {
    auto *self = static_cast<SoundClock *>(data);
    std::lock_guard lock(self->mutex);
    self->reads.push_back(std::chrono::steady_clock::now());
    self->was_read.notify_all();
    return GST_SECOND;
  }
  std::chrono::steady_clock::time_point first_read_after(std::size_t count)
  {
    std::unique_lock lock(mutex);
    was_read.wait(lock, [&] { return reads.size() > count; });
    return reads[count];
  }
  std::size_t count()
  {
    std::lock_guard lock(mutex);
    return reads.size();
  }
};

/// In a pause running time stands still, and the sound may go on before the tactors know.
CHECK_TEST(test_a_sound_clock_is_not_read_in_a_pause)
{
  SoundClock sound;
  g_autoptr(GstClock) clock = gst_audio_clock_new("sound", SoundClock::read, &sound, nullptr);
  SchedulerRig rig(false);
  rig.host.set(clock, milliseconds(0));
  rig.scheduler->flush();
  fail_unless_equals_int(sound.count(), 0);
  rig.push({ command(1500, 0, 2.0) });
  rig.scheduler->play();
  sound.first_read_after(0);
  rig.scheduler->pause();
  const std::size_t paused = sound.count();
  rig.scheduler->flush();
  rig.scheduler->flush();
  fail_unless_equals_int(sound.count(), paused);
}

/// Sound that goes on leaves its clock alone for a while.
CHECK_TEST(test_a_sound_clock_settles)
{
  SoundClock sound;
  g_autoptr(GstClock) clock = gst_audio_clock_new("sound", SoundClock::read, &sound, nullptr);
  SchedulerRig rig(false);
  rig.host.set(clock, milliseconds(0));
  rig.push({ command(1500, 0, 2.0) });
  const std::size_t before = sound.count();
  const auto begin = std::chrono::steady_clock::now();
  rig.scheduler->play();
  fail_unless(sound.first_read_after(before) - begin >= ClockRest::kLength);
}

CHECK_MAIN(tactorscheduler)
