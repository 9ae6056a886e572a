// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/motor_limits.h"

// What one motor may do. planner_limits tests the planner that obeys these limits.

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "motor_account.h"
#include "support/tolerance.h"
#include "unlimited.h"

#include "support/check_tests.h"

CHECK_TEST(test_longest_on_time)
{
  const MotorLimits limits{ .max_on_time = 2s, .max_duty = 0 };
  MotorUse use;
  fail_unless(use.off_since() == Time::min() && use.ready_at() == Time::min());
  fail_unless(use.latest_end(5s, limits).time == 7s);
  use.begin(5s);
  fail_unless(use.is_on() && use.on_since() == 5s && use.off_since() == Time::max());
  use.end(6s, false);
  // A break shorter than 100 ms does not end the cue.
  fail_unless(use.latest_end(6099ms, limits).time == 7s);
  fail_unless(use.latest_end(6100ms, limits).time == 8100ms);
  use.begin(6050ms);
  use.end(6500ms, false);
  fail_unless(use.latest_end(6550ms, limits).time == 7s);
  fail_unless(use.latest_end(6550ms, limits).limit == MotorUse::Limit::on_time);
  // A stretch that is not permitted ends where it begins.
  use.begin(6550ms);
  use.end(7s, true);
  fail_unless(use.ready_at() == 7100ms);
  fail_unless(use.latest_end(7050ms, limits).time == 7050ms);
  fail_unless(use.latest_end(7100ms, limits).time == 9100ms);
  fail_unless(use.latest_end(7100ms, kNoLimits).time == Time::max());
  fail_unless(use.latest_end(7100ms, kNoLimits).limit == MotorUse::Limit::none);
}

CHECK_TEST(test_forget_and_age)
{
  const MotorLimits limits{ .max_on_time = 2s, .max_duty = 0 };
  MotorUse use;
  use.begin(0s);
  use.end(1900ms, false);
  use.begin(2050ms); // another cue, none of which was played
  use.forget_from(1950ms);
  fail_unless(!use.is_on() && use.off_since() == 1900ms);
  use.age(10s);
  fail_unless(use.off_since() == -8100ms);
  fail_unless(use.latest_end(-8050ms, limits).time == -8s);
  use.begin(0s);
  use.forget_from(500ms);
  fail_unless(!use.is_on() && use.off_since() == 500ms);
  use.begin(600ms);
  use.end(900ms, false);
  use.forget_from(700ms);
  fail_unless(use.off_since() == 700ms);
}

/// MotorUse's end against a count of all past milliseconds.
CHECK_TEST(test_duty_against_counting)
{
  std::mt19937 random(7);
  for (int play = 0; play < 60; play++) {
    const double duty = std::uniform_real_distribution(0.02, 0.98)(random);
    const MotorLimits limits{ .max_on_time = 0s, .max_duty = duty };
    const long allowed = static_cast<long>(std::floor(duty * 60'000));
    MotorUse use;
    std::vector<char> on(400'000, 0); // one entry a millisecond
    long now = 0;
    const auto in_minute_before = [&](long end) {
      return std::count(on.begin() + std::max(end - 60'000, 0L), on.begin() + end, 1);
    };
    while (now < 250'000) {
      now += std::uniform_int_distribution(0, 4000)(random);
      const Time asked = use.latest_end(Time(now * 1ms), limits).time;
      // On for as long as the minute that ends then allows.
      long end = now;
      long count = in_minute_before(end);
      while (end < now + 60'000) {
        on[static_cast<std::size_t>(end)] = 1;
        count += 1 - (end >= 60'000 ? on[static_cast<std::size_t>(end - 60'000)] : 0);
        if (count > allowed)
          break;
        end++;
      }
      std::fill(on.begin() + now, on.begin() + end + 1, 0);
      // The allowance is not a whole number of milliseconds.
      fail_unless(asked >= end * 1ms && asked < (end + 1) * 1ms,
                  "at %ld ms: latest end %g ms, expected %ld ms", now, seconds(asked) * 1000, end);
      const long last = std::uniform_int_distribution(now, std::min(end, now + 9000))(random);
      std::fill(on.begin() + now, on.begin() + last, 1);
      use.begin(now * 1ms);
      use.end(last * 1ms, false);
      now = last + 1;
    }
  }
}

/// More stretches than MotorUse stores: what it forgets counts as on.
CHECK_TEST(test_many_stretches_err_on_the_safe_side)
{
  const MotorLimits limits{ .max_on_time = 0s, .max_duty = 0.4 };
  MotorUse use;
  std::vector<Stretch> all;
  Time on{ 0 };
  for (Time now = 0s; now < 120s; now += 20ms) {
    const Time end = std::min(use.latest_end(now, limits).time, now + 10ms);
    if (end == now)
      continue;
    use.begin(now);
    use.end(end, false);
    all.push_back({ now, end });
    on += end - now;
  }
  fail_unless(fullest_minute(all) <= 24s);
  fail_unless(on >= 12s); // half of 24 s a minute, since breaks count as on
}

CHECK_MAIN(motor_limits)
