// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/rumble.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

static constexpr RumbleTimes kTimes{ .duration = 250ms, .renewal = 100ms, .refresh = 80ms };
static constexpr GamepadLevels kZero{};
static constexpr GamepadLevels kLow{ 1, 0, 0, 0 };
static constexpr GamepadLevels kHigh{ 0, 0.5, 0, 0 };

CHECK_TEST(test_begins_with_zero)
{
  Rumble rumble(10ms, kTimes);
  fail_unless(rumble.next(1s) == kZero);
  fail_if(rumble.next(1s).has_value());
  fail_if(rumble.deadline().has_value());
}

CHECK_TEST(test_sends_newest_at_interval)
{
  Rumble rumble(50ms, kTimes);
  rumble.next(0s);
  rumble.set(kLow);
  fail_if(rumble.next(49ms).has_value());
  rumble.set(kHigh);
  fail_unless(rumble.deadline() == 50ms);
  fail_unless(rumble.next(50ms) == kHigh);
  rumble.set(kZero);
  fail_if(rumble.next(99ms).has_value());
  fail_unless(rumble.next(100ms) == kZero);
  fail_if(rumble.deadline().has_value());
}

/// Levels that are not written again are not sent again, and end with their duration.
CHECK_TEST(test_watchdog)
{
  Rumble rumble(10ms, kTimes);
  rumble.next(0s);
  rumble.set(kLow);
  rumble.next(10ms);
  fail_if(rumble.deadline().has_value());
  fail_if(rumble.next(1h).has_value());
}

/// Levels written every `refresh` never end, at any interval.
CHECK_TEST(test_renewal)
{
  for (const Time interval : { Time(10ms), Time(50ms) }) {
    Rumble rumble(interval, kTimes);
    rumble.next(0s);
    Time sent(0);
    int renewals = 0;
    for (Time now = interval; now < 2s; now += 1ms) {
      if ((now - interval) % kTimes.refresh == Time(0))
        rumble.set(kLow);
      if (!rumble.next(now))
        continue;
      fail_unless(now - sent >= interval);
      fail_unless(now - sent < kTimes.duration);
      if (sent != Time(0))
        fail_unless(now - sent >= kTimes.renewal);
      sent = now;
      renewals++;
    }
    fail_unless(renewals > 8);
    fail_unless(2s - sent < kTimes.duration);
  }
}

CHECK_TEST(test_zero_is_not_renewed)
{
  Rumble rumble(10ms, kTimes);
  rumble.next(0s);
  rumble.set(kZero);
  fail_if(rumble.next(1h).has_value());
  fail_if(rumble.is_on());
}

CHECK_TEST(test_interval_of_connection)
{
  fail_unless(shortest_interval({ .vendor = 0x045e }) == 10ms);
  fail_unless(shortest_interval({ .vendor = 0x045e, .is_bluetooth = true }) == 50ms);
  fail_unless(shortest_interval({ .vendor = 0x054c, .is_bluetooth = true }) == 10ms);
}

CHECK_MAIN(rumble)
