// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/soft_start.h"

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

CHECK_TEST(test_steps)
{
  SoftStart start;
  start.set_length(100ms);
  fail_unless(start.ceiling(0s) == 1 && !start.next_step(0s)); // all motors are off
  fail_unless(start.vibrate(5s));
  // A fifth more every 20 ms, the first at once.
  for (int ms = 0; ms < 200; ms++) {
    const Time now = 5s + ms * 1ms;
    fail_unless_near(start.ceiling(now), std::min(ms / 20 + 1, 5) / 5.0, 1e-12);
    const auto next = start.next_step(now);
    fail_unless(next.has_value() == (ms < 80));
    fail_unless(!next || *next == 5s + (ms / 20 + 1) * 20ms);
    fail_unless(!start.vibrate(now)); // already vibrating
  }
  // A clock that jumps back must not hold motors at a low level until the old time returns.
  fail_unless(!start.vibrate(3s));
  fail_unless_near(start.ceiling(2s), 0.2, 1e-12);
  fail_unless_near(start.ceiling(3s + 20ms), 0.4, 1e-12);
  start.arm();
  fail_unless(start.ceiling(6s) == 1);
  fail_unless(start.vibrate(1s)); // time may start again from an earlier value
  fail_unless_near(start.ceiling(1s), 0.2, 1e-12);
}

CHECK_TEST(test_lengths)
{
  // Each step ends on the straight line to full scale, never above it.
  for (const Time length :
       { Time(1ns), Time(19ms), Time(20ms), Time(21ms), Time(250ms), Time(10s) }) {
    SoftStart start;
    start.set_length(length);
    fail_unless(start.vibrate(0s));
    Time now = 0s;
    while (const auto next = start.next_step(now)) {
      fail_unless_near(start.ceiling(now),
                       static_cast<double>(next->count()) / static_cast<double>(length.count()),
                       1e-12);
      fail_unless(*next > now && *next <= length);
      now = *next;
    }
    fail_unless(start.ceiling(now) == 1 && now + 20ms >= length);
  }
  SoftStart none;
  fail_unless(!none.vibrate(0s));
  fail_unless(none.ceiling(0s) == 1 && !none.next_step(0s));
}

CHECK_MAIN(soft_start)
