// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/device_account.h"

// The limits by the clock of the motor, checked by a record of what leaves for it.

#include "tactor/command_planner.h"

#include <algorithm>
#include <random>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "frame_rate.h"
#include "motor_account.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

namespace {

/// A driver's thread: it sends levels when they are written and when the account says so.
class Device
{
public:
  Device(DeviceAccount &account, int tactors)
      : stretches(static_cast<std::size_t>(tactors)), account_(account),
        wanted_(static_cast<std::size_t>(tactors), 0.0), since_(static_cast<std::size_t>(tactors))
  {
  }
  void write(int tactor, double level, Time now)
  {
    run_to(now);
    wanted_[static_cast<std::size_t>(tactor)] = level;
    send(now);
  }
  void run_to(Time now)
  {
    for (std::optional<Time> next = account_.deadline(); next && *next <= now;
         next = account_.deadline())
      send(*next);
  }
  bool is_on(int tactor) const
  {
    return since_[static_cast<std::size_t>(tactor)].has_value();
  }

  std::vector<std::vector<Stretch>> stretches; ///< of each tactor, in order

private:
  void send(Time now)
  {
    std::vector<double> levels = wanted_;
    account_.admit(levels, now);
    for (std::size_t i = 0; i < levels.size(); i++) {
      fail_unless(levels[i] == 0 || levels[i] == wanted_[i]);
      if (levels[i] > 0 && !since_[i])
        since_[i] = now;
      if (levels[i] == 0 && since_[i])
        stretches[i].push_back({ *std::exchange(since_[i], std::nullopt), now });
    }
  }

  DeviceAccount &account_;
  std::vector<double> wanted_;
  std::vector<std::optional<Time>> since_;
};

} // namespace

/// Whoever writes the levels gets no CPU time: zeros come up to 3 s late, or not at all.
CHECK_TEST(test_limits_hold_whoever_is_late)
{
  DeviceAccount account;
  account.set_limits({});
  Device device(account, 3);
  std::mt19937 random(5);
  const auto dice = [&](int most) {
    return std::uniform_int_distribution(0, most)(random) * 1ms;
  };
  for (int tactor = 0; tactor < 3; tactor++) {
    Time now = 100s * tactor;
    while (now < 100s * tactor + 90s) {
      device.write(tactor, 0.5, now);
      now += 20ms + dice(1500);
      device.write(tactor, 1, now); // another level is the same cue
      now += dice(3000);
      if (dice(3) != 0ms) {
        device.write(tactor, 0, now);
        now += 120ms + dice(800);
      }
    }
    device.write(tactor, 0, now);
  }
  fail_unless(account.cuts() > 20);
  for (const std::vector<Stretch> &stretches : device.stretches) {
    fail_unless(stretches.size() > 10);
    fail_unless(longest_cue(stretches) <= 2s + DeviceAccount::kGrace);
    fail_unless(longest_cue(stretches) >= 2s);
    fail_unless(fullest_minute(stretches) <= 24s + DeviceAccount::kGrace);
    fail_unless(fullest_minute(stretches) >= 20s);
  }
}

/// A scheduler that is in time, but for some milliseconds, keeps the limits itself.
CHECK_TEST(test_nothing_is_cut_of_what_is_in_time)
{
  DeviceAccount account;
  account.set_limits({ .max_duty = 0 });
  Device device(account, 1);
  for (Time now = 0s; now < 60s; now += 4s) {
    device.write(0, 1, now);
    device.write(0, 0, now + 2s + 9ms);
    device.write(0, 1,
                 now + 2s + 100ms); // the planner's shortest rest, less what the zero was late
    device.write(0, 0, now + 3s);
  }
  ck_assert_uint_eq(account.cuts(), 0);
  ck_assert_uint_eq(device.stretches[0].size(), 30);
}

/// A level that was cut begins again when it was let go, or after 3 s.
CHECK_TEST(test_a_cut_level_rests)
{
  DeviceAccount account;
  account.set_limits({ .max_on_time = 1s, .max_duty = 0 });
  Device device(account, 1);
  device.write(0, 1, 0s);
  device.run_to(3s);
  fail_if(device.is_on(0));
  device.run_to(4s + 9ms);
  fail_if(device.is_on(0));
  device.run_to(4s + 10ms);
  fail_unless(device.is_on(0));
  device.run_to(6s);
  fail_if(device.is_on(0)); // since 5.02 s
  device.write(0, 0, 6s);
  device.write(0, 1, 6s);
  fail_unless(device.is_on(0));
  account.set_limits(MotorLimits::none());
  device.write(0, 1, 6500ms); // as refreshed all along
  device.run_to(60s);
  fail_unless(device.is_on(0));
  fail_if(account.deadline());
}

/// One that was cut, let go and wanted again at once begins when the shortest rest is over: that is
/// another cue.
CHECK_TEST(test_a_cut_level_is_wanted_again)
{
  DeviceAccount account;
  account.set_limits({ .max_on_time = 1s, .max_duty = 0 });
  Device device(account, 1);
  device.write(0, 1, 0s); // cut at 1.01 s
  device.write(0, 0, 1020ms);
  device.write(0, 1, 1030ms);
  fail_if(device.is_on(0));
  device.run_to(1010ms + DeviceAccount::kShortestRest);
  fail_unless(device.is_on(0));
  device.run_to(2s);
  fail_unless(device.is_on(0));
  ck_assert_uint_eq(account.cuts(), 1);
}

/// Motors beyond the levels are at zero, and a device that is gone has no levels at all.
CHECK_TEST(test_motors_without_levels)
{
  DeviceAccount account;
  account.set_limits({ .max_on_time = 1s, .max_duty = 0 });
  std::vector<double> levels{ 1 };
  account.admit(levels, 0s);
  account.admit({}, 500ms);
  fail_if(account.deadline());
  account.admit(levels, 2s);
  fail_unless(levels[0] == 1);
  // Of a motor that is on, the time until now counts, and no more.
  const MotorUse use = account.uses(2500ms).at(0);
  fail_if(use.is_on());
  fail_unless(use.off_since() == 2500ms);
  ck_assert_uint_eq(account.cuts(), 0);
}

/// An application that restarts its pipeline every two seconds: each play has a new planner and a
/// new running time. The limit of the device is that of one long play, and it is the planner that
/// keeps it.
CHECK_TEST(test_restarts_get_no_new_account)
{
  const std::string name = "chair of test_restarts_get_no_new_account";
  fail_unless(DeviceAccount::of(name) == DeviceAccount::of(name));
  fail_if(DeviceAccount::of(name) == DeviceAccount::of("another"));
  Device device(*DeviceAccount::of(name), 1);
  std::uint64_t limited = 0;
  for (Time start = 1000h; start < 1000h + 100s; start += 2s) {
    const std::shared_ptr<DeviceAccount> account = DeviceAccount::of(name);
    account->set_limits({});
    PlannerSettings settings{ .rate = 0, .compensation = Compensation::none };
    CommandPlanner planner(1, settings);
    planner.resume(account->uses(start), start);
    std::vector<Command> commands;
    for (Time time = 0s; time < 1900ms; time += 100ms)
      for (const Command &command : planner.plan(time, 100ms, std::vector<float>{ 1 }))
        commands.push_back(command);
    for (const Command &command : planner.silence(1900ms))
      commands.push_back(command);
    for (const Command &command : commands)
      device.write(0, command.volts / 3, start + command.due());
    limited += planner.limited().duty;
  }
  fail_unless(fullest_minute(device.stretches[0]) <= 24s + DeviceAccount::kGrace);
  fail_unless(fullest_minute(device.stretches[0]) >= 23s);
  fail_unless(limited > 0);
  ck_assert_uint_eq(DeviceAccount::of(name)->cuts(), 0);
}

/// Running time that begins late, or is silenced before the first map, keeps the account, too.
CHECK_TEST(test_resumed_account_is_on_any_time_line)
{
  DeviceAccount account;
  account.set_limits({});
  Device device(account, 1);
  for (Time now = 0s; now < 36s; now += 3s) { // 24 s
    device.write(0, 1, now);
    device.write(0, 0, now + 2s);
  }
  for (const Time first : { Time(-10s), Time(0), Time(500s), Time(24h * 365 * 20) }) {
    for (const bool flushes : { false, true }) {
      CommandPlanner planner(1, { .rate = 0, .compensation = Compensation::none });
      planner.resume(account.uses(36s), 36s);
      if (flushes) {
        planner.silenced(3s);
        planner.reset(4s);
        planner.silenced(1s);
      }
      fail_unless(planner.plan(first, 100ms, std::vector<float>{ 1 }).empty());
      // The oldest 2 s of the minute are over 26 s later.
      fail_if(planner.plan(first + 27s, 100ms, std::vector<float>{ 1 }).empty());
    }
  }
}

CHECK_MAIN(device_account)
