// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Reports of a film that is heard, and when a failed listener is tried again, at set times.
#include "visuotactile-follow/film_listener.h"
#include "visuotactile-follow/retry.h"

#include "follow/position_estimator.h"

#include <chrono>

#include "support/unwrap.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using follow::Time;

namespace {

constexpr Time kHeardAt = 100s; ///< local time

follow::PositionEstimator
estimator()
{
  return follow::PositionEstimator({ .habits = FilmListener::kHabits });
}

} // namespace

/// At local time t the sound of film position p has its time stamp; it left the screen `latency`
/// before. So at t the film is at p + latency · rate.
CHECK_TEST(test_latency)
{
  for (const Time latency : { -200ms, 0ms, 200ms })
    for (const double rate : { 1.0, 25.0 / 24 }) {
      const listen::Heard heard{
        .film = 1, .at = kHeardAt, .position = 600s, .rate = rate, .begins = true
      };
      const Time now = kHeardAt + 50ms; // it took so long to look
      auto reports = estimator();
      reports.report(FilmListener::report(heard, "heard://1/a", latency, now));
      const auto estimate = reports.at(now + 1s);
      fail_unless(estimate.has_value());
      const double truth = 600 + (1.05 + std::chrono::duration<double>(latency).count()) * rate;
      const double error = std::chrono::duration<double>(estimate->position).count() - truth;
      fail_unless(std::abs(error) < 1e-6, "%.0f ms, rate %f: %.6f s off",
                  std::chrono::duration<double, std::milli>(latency).count(), rate, error);
      fail_unless_equals_float(estimate->rate, rate);
    }
}

/// Positions in a room vary by 8 ms: none is a leap, and none is doubted.
CHECK_TEST(test_room)
{
  auto reports = estimator();
  for (int look = 0; look < 40; look++) {
    const Time at = kHeardAt + look * 500ms;
    const Time off = look % 3 == 0 ? 8ms : look % 3 == 1 ? -8ms : 0ms;
    const listen::Heard heard{ .at = at,
                               .position = 600s + look * 500ms + off,
                               .begins = look == 0 };
    reports.report(FilmListener::report(heard, "heard://1/a", 0ms, at));
    fail_if(reports.asks_again(), "look %d is doubted", look);
    const auto estimate = reports.at(at);
    fail_unless(estimate && std::chrono::abs(estimate->position - 600s - look * 500ms) <= 10ms);
  }
}

CHECK_TEST(test_retry)
{
  Retry retry;
  fail_unless(retry.is_due(0s));
  Time now = 100s;
  for (const Time wait : { 2s, 4s, 8s, 16s, 32s, 60s, 60s }) {
    retry.failed(now);
    fail_if(retry.is_due(now + wait - 1ms));
    now += wait;
    fail_unless(retry.is_due(now));
  }
  retry.worked();
  retry.failed(now);
  fail_unless(retry.is_due(now + 2s));
}

CHECK_MAIN(film_listener)
