// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Estimates of a film's position against the position itself, which simulated players report late,
// rounded, jittery and sometimes wrongly, in times of their own.
#include "follow/position_estimator.h"

#include "support/follow_peers.h"
#include "support/simulated_player.h"

#include <limits>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

constexpr Time kBegin = 100s;
constexpr double kSkews[] = { -200e-6, 0, 200e-6 };

double
milliseconds(Time time)
{
  return static_cast<double>(time.count()) / 1e6;
}

/// The value below which `share` of these lie.
double
quantile(std::vector<double> of, double share)
{
  std::ranges::sort(of);
  fail_if(of.empty());
  return of[static_cast<std::size_t>(share * static_cast<double>(of.size() - 1))];
}

struct Errors
{
  std::vector<double> ours{}; ///< ms, absolute, where the position is known
  std::vector<double> median{};
  std::vector<double> third{};
  std::size_t asked = 0;
  std::size_t beyond_bound = 0; ///< of ours
};

/// Compares every 0.1 s from 10 s on.
Errors
compare(const WatchedFilm &film, const Telling &telling, Time length)
{
  PositionEstimator estimator({ .habits = { .coarseness = telling.coarseness } });
  MedianOfOffsets median;
  ThirdOfTheWay third;
  Errors errors;
  Time now = kBegin + 10s;
  for (const Report &report : reports_of(film, telling, kBegin + length, 11)) {
    for (; now < report.received; now += 100ms) {
      const Time truth = film.position(now);
      errors.asked++;
      if (const auto estimate = estimator.at(now)) {
        const Time off = estimate->position - truth;
        errors.ours.push_back(std::abs(milliseconds(off)));
        errors.beyond_bound += std::chrono::abs(off) > estimate->error;
      }
      errors.median.push_back(std::abs(milliseconds(median.at(now) - truth)));
      errors.third.push_back(std::abs(milliseconds(third.at(now) - truth)));
    }
    estimator.report(report);
    median.report(report);
    third.report(report);
  }
  return errors;
}

/// A report of a film that plays, pushed without delay.
Report
told(Time received, Time position)
{
  return { .received = received, .position = position, .film = "film" };
}

/// Frames of 40 ms from a position on, each told at once. Returns the time after the last.
Time
play(PositionEstimator &estimator, Time from, Time position, int frames, double rate = 1)
{
  for (int i = 0; i < frames; i++) {
    Report report = told(from + i * 40ms, position + i * Time(std::llround(rate * 40e6)));
    report.rate = rate;
    estimator.report(report);
  }
  return from + frames * 40ms;
}

void
assert_near(const PositionEstimator &estimator, Time now, Time position, Time tolerance = 2ms)
{
  const auto estimate = estimator.at(now);
  fail_unless(estimate.has_value(), "it is not known");
  const Time off = estimate->position - position;
  fail_unless(std::chrono::abs(off) <= tolerance, "off by %.1f ms", milliseconds(off));
}

} // namespace

/// Two hours with clocks that differ.
CHECK_TEST(test_two_hours)
{
  const struct
  {
    Telling telling;
    double p95; ///< ms
  } kinds[] = { { told_by_frame(), 1.5 },
                { told_when_asked(250ms), 1 },
                { told_when_asked(1s), 2 },
                { told_in_seconds(), 35 } };
  for (const auto &[telling, p95] : kinds) {
    double ours = 0;
    double median = 0;
    double third = 0;
    for (const double skew : kSkews) {
      // Of reports of each frame, which take time under sanitizers, once.
      const Time length = telling.every < 100ms && skew < 200e-6 ? Time(10min) : Time(2h);
      const Errors errors = compare(WatchedFilm(kBegin, 5s, skew), telling, length);
      fail_unless(errors.ours.size() > errors.asked * 99 / 100, "known %zu of %zu times",
                  errors.ours.size(), errors.asked);
      fail_unless(quantile(errors.ours, 0.95) < p95, "%.2f ms", quantile(errors.ours, 0.95));
      // No drift: the last minutes are as good as the first.
      const std::vector<double> last(errors.ours.end() - 3'000, errors.ours.end());
      fail_unless(quantile(last, 0.95) < 1.2 * p95, "%.2f ms at the end", quantile(last, 0.95));
      fail_unless(errors.beyond_bound < errors.asked / 20, "%zu of %zu beyond the bound",
                  errors.beyond_bound, errors.asked);
      ours = std::max(ours, quantile(errors.ours, 0.95));
      median = std::max(median, quantile(errors.median, 0.95));
      third = std::max(third, quantile(errors.third, 0.95));
    }
    fail_unless(ours * 2 <= median, "p95 %.2f ms, of medians %.2f ms", ours, median);
    fail_unless(ours * 2 <= third, "p95 %.2f ms, of thirds of the way %.2f ms", ours, third);
  }
}

/// A player that fits the film to the screen: 23.976 frames on 24 Hz.
CHECK_TEST(test_resampled)
{
  for (const double skew : { -1e-3, 1e-3 }) {
    const Errors errors = compare(WatchedFilm(kBegin, 0s, skew), told_by_frame(), 10min);
    fail_unless(quantile(errors.ours, 0.95) < 4, "%.2f ms", quantile(errors.ours, 0.95));
  }
}

CHECK_TEST(test_wrong_reports)
{
  for (Telling telling : { told_by_frame(), told_when_asked(250ms) }) {
    for (const Time off : { Time(60ms), Time(20s) }) {
      telling.wrong = 0.01;
      telling.off = off;
      const Errors errors = compare(WatchedFilm(kBegin, 60s, 0), telling, 20min);
      fail_unless(quantile(errors.ours, 0.95) < 4, "%.2f ms", quantile(errors.ours, 0.95));
      fail_unless(errors.ours.size() > errors.asked * 95 / 100);
    }
  }
}

/// Within a stretch, film time goes on at nearly the film's rate whatever is reported.
CHECK_TEST(test_never_backwards)
{
  Telling telling = told_by_frame();
  telling.hiccups = 0.3;
  telling.wrong = 0.02;
  telling.off = 120ms;
  PositionEstimator estimator;
  const WatchedFilm film(kBegin, 60s, 100e-6);
  std::optional<PositionEstimator::Estimate> before;
  Time now = kBegin;
  int compared = 0;
  for (const Report &report : reports_of(film, telling, kBegin + 20min, 5)) {
    for (; now < report.received; now += 5ms) {
      const auto estimate = estimator.at(now);
      if (before && estimate && before->stretch == estimate->stretch) {
        const double went = milliseconds(estimate->position - before->position);
        fail_unless(went > 3.9 && went < 6.1, "%.3f ms in 5 ms", went);
        compared++;
      }
      before = estimate;
    }
    estimator.report(report);
  }
  fail_unless(compared > 200'000, "%d", compared);
}

/// A seek that the player tells.
CHECK_TEST(test_told_seek)
{
  PositionEstimator estimator;
  const Time now = play(estimator, kBegin, 10s, 50);
  const auto before = estimator.at(now - 1ms);
  fail_unless(before.has_value());
  Report seek = told(now, 300s);
  seek.sought = true;
  estimator.report(seek);
  assert_near(estimator, now, 300s);
  fail_if(estimator.at(now)->stretch == before->stretch);

  // One that is told before its position is known: nothing stale meanwhile.
  Report begins = { .received = now + 40ms, .sought = true, .film = "film" };
  estimator.report(begins);
  fail_if(estimator.at(now + 40ms).has_value());
  estimator.report(told(now + 80ms, 20s));
  assert_near(estimator, now + 80ms, 20s);
}

/// A seek that the player does not tell is told from a wrong report by the next one.
/// A player that puts its position right by a little has not leapt: nothing that is felt is cut.
CHECK_TEST(test_put_right)
{
  PositionEstimator estimator;
  const Time now = play(estimator, kBegin, 10s, 50);
  const std::uint64_t stretch = estimator.at(now)->stretch;
  Report right = told(now, 12s + 30ms);
  right.sought = true;
  estimator.report(right);
  fail_unless(estimator.at(now)->stretch == stretch);
  assert_near(estimator, now, 12s);
  assert_near(estimator, play(estimator, now + 40ms, 12s + 70ms, 10), 12s + 470ms);
  fail_unless(estimator.at(now + 440ms)->stretch == stretch);
  // Further is a leap.
  right = told(now + 440ms, 12s + 530ms);
  right.sought = true;
  estimator.report(right);
  fail_unless(estimator.at(now + 440ms)->stretch != stretch);
  assert_near(estimator, now + 440ms, 12s + 530ms);
}

CHECK_TEST(test_untold_seek)
{
  for (const Time to : { Time(10min), Time(11s) }) {
    PositionEstimator estimator;
    Time now = play(estimator, kBegin, 60s, 50);
    estimator.report(told(now, to));
    fail_if(estimator.at(now).has_value(), "it does not know which");
    fail_unless(estimator.asks_again());
    estimator.report(told(now + 40ms, to + 40ms));
    assert_near(estimator, now + 40ms, to + 40ms);
    fail_if(estimator.asks_again());
  }
}

CHECK_TEST(test_lone_wrong_report)
{
  PositionEstimator estimator;
  const Time now = play(estimator, kBegin, 60s, 50);
  estimator.report(told(now, 5min));
  fail_if(estimator.at(now).has_value());
  estimator.report(told(now + 40ms, 62s + 40ms));
  assert_near(estimator, now + 40ms, 62s + 40ms);
  // A small one changes nothing.
  estimator.report(told(now + 80ms, 62s - 60ms));
  assert_near(estimator, now + 80ms, 62s + 80ms);
}

CHECK_TEST(test_pause)
{
  PositionEstimator estimator;
  const Time now = play(estimator, kBegin, 60s, 50);
  Report pause = { .received = now, .doing = Doing::paused, .film = "film" };
  estimator.report(pause);
  assert_near(estimator, now, 62s);
  ck_assert(estimator.at(now)->rate == 0);
  assert_near(estimator, now + 1h, 62s); // it stands, however long
  fail_if(estimator.known_until().has_value());
  pause.position = 61s + 980ms;
  pause.received = now + 1h;
  estimator.report(pause);
  ck_assert(estimator.at(now + 1h)->position == 61s + 980ms);

  // It plays from the first report of another position on.
  Time resumed = now + 2h;
  estimator.report({ .received = resumed, .film = "film" });
  ck_assert(estimator.at(resumed)->rate == 0);
  estimator.report(told(resumed + 30ms, 61s + 980ms));
  ck_assert(estimator.at(resumed + 30ms)->rate == 0);
  estimator.report(told(resumed + 70ms, 62s + 20ms));
  ck_assert(estimator.at(resumed + 70ms)->rate == 1);
  assert_near(estimator, resumed + 170ms, 62s + 120ms);
}

CHECK_TEST(test_rate)
{
  PositionEstimator estimator;
  Time now = play(estimator, kBegin, 60s, 50);
  const auto before = estimator.at(now);
  estimator.report({ .received = now, .rate = 1.25, .film = "film" }); // without a position
  assert_near(estimator, now, 62s);
  const auto after = estimator.at(now);
  ck_assert(after->rate == 1.25 && after->stretch != before->stretch);
  assert_near(estimator, now + 200ms, 62s + 250ms);
  now = play(estimator, now, 62s, 50, 1.25);
  assert_near(estimator, now, 62s + 2500ms);
  now = play(estimator, now, 64s + 500ms, 50, 0.5);
  assert_near(estimator, now, 65s + 500ms);

  // Backwards, and faster or slower than anybody watches.
  for (const double rate : { -1.0, 32.0, 1e-12 }) {
    Report odd = told(now, 65s);
    odd.rate = rate;
    estimator.report(odd);
    fail_if(estimator.at(now).has_value(), "at rate %g", rate);
    now = play(estimator, now, 65s, 10, 1);
    fail_unless(estimator.at(now).has_value());
  }
}

/// It waits for data: the position stands, or nothing more is told.
CHECK_TEST(test_stall)
{
  PositionEstimator estimator;
  const auto asked = [&estimator](Time at, Time position) {
    Report report = told(at + 1ms, position);
    report.asked = at;
    estimator.report(report);
  };
  for (int i = 0; i < 20; i++)
    asked(kBegin + i * 250ms, 60s + i * 250ms);
  const Time now = kBegin + 5s;
  ck_assert(estimator.at(now)->rate == 1);
  asked(now, 64s + 750ms);
  ck_assert(estimator.at(now + 1ms)->rate == 0);
  ck_assert(estimator.at(now + 1ms)->position == 64s + 750ms);
  asked(now + 250ms, 65s);
  ck_assert(estimator.at(now + 251ms)->rate == 1);

  PositionEstimator silent;
  const Time end = play(silent, kBegin, 60s, 50);
  assert_near(silent, end + 200ms, 62s + 200ms);
  fail_if(silent.at(end + 300ms).has_value());
  ck_assert(silent.known_until() == end - 40ms + 300ms);
  Report stalled = { .received = end, .doing = Doing::stalled, .film = "film" };
  silent.report(stalled);
  ck_assert(silent.at(end)->rate == 0);
}

/// Slow films have few frames.
CHECK_TEST(test_patience)
{
  PositionEstimator estimator;
  for (int i = 0; i < 10; i++)
    estimator.report(told(kBegin + i * 500ms, i * 500ms));
  const Time last = kBegin + 4500ms;
  ck_assert(estimator.known_until() == last + 1500ms);
  PositionEstimator slow;
  for (int i = 0; i < 10; i++)
    slow.report(told(kBegin + i * 2s, i * 2s));
  ck_assert(slow.known_until() == kBegin + 18s + 3s);
}

/// Frames may be further apart than a player that hangs is waited for, if it says that it plays.
CHECK_TEST(test_far_frames)
{
  for (const bool lives : { true, false }) {
    PositionEstimator estimator;
    const Time last = play(estimator, kBegin, 5s, 50) - 40ms;
    const std::uint64_t stretch = estimator.at(last)->stretch;
    const Time position = 5s + 49 * 40ms;
    for (Time after = 60ms; after < 567ms; after += 60ms) {
      if (lives)
        estimator.report({ .received = last + after, .film = "film" });
      const auto estimate = estimator.at(last + after);
      fail_unless(estimate.has_value() == (lives || after <= 300ms), "%lld ms",
                  static_cast<long long>(after / 1ms));
      if (estimate)
        fail_unless(std::chrono::abs(estimate->position - position - after) < 5ms);
    }
    estimator.report(told(last + 567ms, position + 567ms));
    fail_unless((estimator.at(last + 567ms)->stretch == stretch) == lives);
    // And then it hangs.
    fail_unless(!lives || !estimator.at(last + 567ms + 301ms));
  }
}

CHECK_TEST(test_new_film)
{
  PositionEstimator estimator;
  const Time now = play(estimator, kBegin, 60s, 50);
  const auto before = estimator.at(now);
  Report next = told(now, 0s);
  next.film = "sequel";
  estimator.report(next);
  assert_near(estimator, now, 0s);
  fail_if(estimator.at(now)->stretch == before->stretch);
  estimator.report({ .received = now, .doing = Doing::stopped, .film = "sequel" });
  fail_if(estimator.at(now).has_value());
}

/// A position that is known to half a second only is none.
CHECK_TEST(test_too_coarse)
{
  PositionEstimator estimator({ .habits = { .coarseness = 1s } });
  const auto asked = [&estimator](Time at) {
    Report report = told(at, (at - kBegin) - (at - kBegin) % 1s);
    report.asked = at;
    estimator.report(report);
  };
  asked(kBegin + 1300ms);
  fail_if(estimator.at(kBegin + 1300ms).has_value());
  fail_unless(estimator.asks_again());
  // 0.9 s into a second and 0.1 s into one: known to a tenth either way.
  asked(kBegin + 2900ms);
  asked(kBegin + 4100ms);
  fail_unless(estimator.at(kBegin + 4100ms).has_value());
  assert_near(estimator, kBegin + 4100ms, 4100ms, 110ms);
  ck_assert(estimator.at(kBegin + 4100ms)->error >= 95ms);
}

CHECK_TEST(test_nonsense)
{
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  PositionEstimator estimator;
  fail_if(estimator.at(kBegin).has_value());
  const Time now = play(estimator, kBegin, 60s, 50);
  for (const Time position : { Time(-1s), Time(200h), Time::max(), Time::min() })
    estimator.report(told(now, position));
  for (const double rate : { kNan, kInfinite, -kInfinite }) {
    Report report = told(now, 300s);
    report.rate = rate;
    estimator.report(report);
  }
  assert_near(estimator, now, 62s);
  estimator.report(told(kBegin, 60s)); // late by two seconds
  assert_near(estimator, now, 62s);
}

/// A position that is told twice within a tenth of a second was not renewed yet.
CHECK_TEST(test_told_twice)
{
  PositionEstimator estimator;
  const auto tell = [&estimator](Time asked, Time position) {
    estimator.report(
        { .received = asked + 1ms, .asked = asked, .position = position, .film = "f" });
  };
  for (Time at = 10s; at < 12s; at += 150ms)
    tell(at, at);
  const Time last = 11950ms;
  tell(last + 60ms, last);
  assert_near(estimator, last + 70ms, last + 70ms, 5ms);
  ck_assert(estimator.at(last + 70ms)->rate == 1);
  tell(last + 120ms, last);
  ck_assert(estimator.at(last + 130ms)->rate == 0);
}

CHECK_MAIN(position_estimator)
