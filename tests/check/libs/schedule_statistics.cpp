// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/schedule_statistics.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

/// The absolute values of all errors, sorted on request.
struct Sorted
{
  std::vector<std::int64_t> values;

  void add(Time error)
  {
    values.push_back(std::abs(error.count()));
  }

  /// The smallest value that `permille` of all values do not exceed.
  std::int64_t percentile(std::int64_t permille)
  {
    std::ranges::sort(values);
    const auto count = static_cast<std::int64_t>(values.size());
    const std::int64_t rank = std::max<std::int64_t>((permille * count + 999) / 1000, 1);
    return values[static_cast<std::size_t>(rank - 1)];
  }
};

/// Compares mean, extremes and percentiles. Percentiles may be one bin too high.
void
compare(const ScheduleStatistics &statistics, Sorted &sorted)
{
  std::ranges::sort(sorted.values);
  long double sum = 0;
  for (const std::int64_t value : sorted.values)
    sum += value;
  const auto count = static_cast<long double>(sorted.values.size());
  fail_unless(statistics.count() == sorted.values.size());
  fail_unless(statistics.min().count() == sorted.values.front());
  fail_unless(statistics.max().count() == sorted.values.back());
  fail_unless(std::abs(statistics.mean().count() - std::llround(sum / count)) <= 1);
  for (const std::int64_t permille : { 0, 1, 10, 100, 250, 500, 750, 900, 990, 999, 1000 }) {
    const std::int64_t exact = sorted.percentile(permille);
    const std::int64_t got = statistics.percentile(static_cast<double>(permille) / 1000).count();
    if (exact >= 1'000'000'000)
      fail_unless(got == sorted.values.back());
    else
      fail_unless(got >= exact && got <= exact + ScheduleStatistics::kBin.count(),
                  "%d ‰ are at %" G_GINT64_FORMAT " ns, not %" G_GINT64_FORMAT,
                  static_cast<int>(permille), got, exact);
    fail_unless(got <= sorted.values.back());
  }
}

} // namespace

CHECK_TEST(test_empty)
{
  const ScheduleStatistics none;
  fail_unless(none.count() == 0);
  fail_unless(none.min() == 0ns && none.mean() == 0ns && none.max() == 0ns);
  for (const double share : { 0.0, 0.5, 0.99, 1.0 })
    fail_unless(none.percentile(share) == 0ns);
}

CHECK_TEST(test_by_hand)
{
  ScheduleStatistics statistics;
  for (const Time error : { Time(40us), Time(-20us), Time(0us), Time(100us) })
    statistics.add(error);
  fail_unless(statistics.count() == 4);
  fail_unless(statistics.min() == 0us);
  fail_unless(statistics.mean() == 40us);
  fail_unless(statistics.max() == 100us);
  // The upper edges of the bins of 0, 20, 40 and 100 µs, limited to the maximum.
  fail_unless(statistics.percentile(0) == 10us);
  fail_unless(statistics.percentile(0.25) == 10us);
  fail_unless(statistics.percentile(0.5) == 30us);
  fail_unless(statistics.percentile(0.75) == 50us);
  fail_unless(statistics.percentile(0.76) == 100us);
  fail_unless(statistics.percentile(1) == 100us);
}

CHECK_TEST(test_one_value)
{
  for (const Time error : { Time(0), Time(1), Time(10us), Time(1s), Time(1h), Time(-7ms) }) {
    ScheduleStatistics statistics;
    statistics.add(error);
    const Time value = error < 0s ? -error : error;
    fail_unless(statistics.min() == value && statistics.mean() == value
                && statistics.max() == value);
    fail_unless(statistics.percentile(0) == value);
    fail_unless(statistics.percentile(0.99) == value);
  }
}

CHECK_TEST(test_against_sorting)
{
  std::mt19937 random(1);
  for (const double spread : { 3e3, 1e6, 4e8, 3e9 })
    for (const int count : { 1, 2, 3, 10, 101, 5000 }) {
      std::normal_distribution<double> error(spread / 3, spread);
      ScheduleStatistics statistics;
      Sorted sorted;
      for (int i = 0; i < count; i++) {
        const Time one(std::llround(error(random)));
        statistics.add(one);
        sorted.add(one);
      }
      compare(statistics, sorted);
    }
}

CHECK_TEST(test_beyond_a_second)
{
  ScheduleStatistics statistics;
  Sorted sorted;
  for (const Time error : { Time(1s) - 1ns, Time(1s), Time(5s), Time(-3h), Time(1ms) }) {
    statistics.add(error);
    sorted.add(error);
  }
  compare(statistics, sorted);
  fail_unless(statistics.percentile(0.4) == 1s);
  fail_unless(statistics.percentile(0.6) == 3h);
}

CHECK_TEST(test_extremes)
{
  ScheduleStatistics statistics;
  statistics.add(Time::min());
  fail_unless(statistics.max() == Time::max());
  statistics.add(Time::max());
  statistics.add(0s);
  fail_unless(statistics.min() == 0s);
  fail_unless(statistics.max() == Time::max());
  fail_unless(statistics.percentile(1) == Time::max());
}

CHECK_TEST(test_a_million)
{
  std::mt19937 random(2);
  std::exponential_distribution<double> error(1 / 200e3); // 0.2 ms on average
  ScheduleStatistics statistics;
  Sorted sorted;
  for (int i = 0; i < 1'000'000; i++) {
    const Time one(std::llround(error(random)) * (i % 2 ? 1 : -1));
    statistics.add(one);
    sorted.add(one);
  }
  compare(statistics, sorted);
}

CHECK_MAIN(schedule_statistics)
