// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/rise_time.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double
milliseconds(Time time)
{
  return std::chrono::duration<double, std::milli>(time).count();
}

/// A table of random rise times.
RiseTimeTable
random_table(int size, double step, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> time(0.0, 300.0);
  RiseTimeTable table{ .step_volts = step, .size = size, .milliseconds = {} };
  for (int i = 0; i < size * size; i++)
    table.milliseconds.push_back(time(random));
  return table;
}

/// Bilinear interpolation as a sum over the whole grid: each point is weighted by the product of
/// its two hat functions.
double
sum_of_hats(const RiseTimeTable &table, double start, double target)
{
  const double edge = (table.size - 1) * table.step_volts;
  const double s = std::min(std::max(start, 0.0), edge);
  const double t = std::min(std::max(target, 0.0), edge);
  const auto hat = [&](double volts, int point) {
    return std::max(0.0, 1.0 - std::abs(volts - point * table.step_volts) / table.step_volts);
  };
  double sum = 0;
  for (int i = 0; i < table.size; i++)
    for (int j = 0; j < table.size; j++)
      sum += hat(s, i) * hat(t, j)
             * table.milliseconds[static_cast<std::size_t>(i * table.size + j)];
  return sum;
}

} // namespace

CHECK_TEST(test_equation_1)
{
  struct Case
  {
    double start;
    double offset;
    double ms;
  };
  // By hand: 241.9 − 175.7 Vd − 117.7 Vs + 38.86 Vd² + 49.59 Vd Vs + 18.07 Vs²
  const Case cases[] = {
    { 0.0, 0.5, 163.765 },    // 241.9 − 87.85 + 9.715
    { 0.0, 1.0, 105.06 },     // 241.9 − 175.7 + 38.86
    { 0.0, 2.26, 43.299336 }, // 241.9 − 397.082 + 198.481336
    { 0.0, 3.0, 64.54 },      // 241.9 − 527.1 + 349.74
    { 0.5, 0.5, 121.83 },     // 241.9 − 87.85 − 58.85 + 9.715 + 12.3975 + 4.5175
    { 1.0, 1.0, 55.02 },      // 241.9 − 175.7 − 117.7 + 38.86 + 49.59 + 18.07
    { 1.0, 2.0, 45.49 },      // 241.9 − 351.4 − 117.7 + 155.44 + 99.18 + 18.07
    { 2.0, 0.5, 50.235 },     // 241.9 − 87.85 − 235.4 + 9.715 + 49.59 + 72.28
    { 2.0, 1.0, 41.12 },      // 241.9 − 175.7 − 235.4 + 38.86 + 99.18 + 72.28
  };
  const RiseTime rise;
  for (const Case &c : cases) {
    fail_unless_near(rise_time_quadratic_ms(c.start, c.offset), c.ms, 1e-9);
    // To the nanosecond: rounding in start + offset may cost one more.
    fail_unless_near(milliseconds(rise(c.start, c.start + c.offset)), c.ms, 2e-6);
  }
  // Not monotonic: from rest the minimum is at 175.7 / (2 · 38.86) = 2.2607 V.
  fail_unless(rise(0, 2.26) < rise(0, 2.2));
  fail_unless(rise(0, 2.26) < rise(0, 2.35));
}

CHECK_TEST(test_nothing_to_compensate)
{
  const RiseTime table(RiseTimeTable{ .step_volts = 1, .size = 1, .milliseconds = { 60 } });
  for (const RiseTime &rise : { RiseTime(), table }) {
    // Slower or unchanged
    fail_unless(rise(3, 1) == 0ns);
    fail_unless(rise(1, 1) == 0ns);
    fail_unless(rise(3, 0) == 0ns);
    fail_unless(rise(kInfinity, 3) == 0ns);
    // Below 0.5 V, where the motor does not turn
    fail_unless(rise(0, 0.4999) == 0ns);
    fail_unless(rise(0, 0.5) > 0ns);
    fail_unless(rise(-1, 0) == 0ns);
    // NaN
    fail_unless(rise(kNan, 3) == 0ns);
    fail_unless(rise(0, kNan) == 0ns);
    fail_unless(rise(kNan, kNan) == 0ns);
  }
}

CHECK_TEST(test_range)
{
  const RiseTime slow(RiseTimeTable{ .step_volts = 1, .size = 1, .milliseconds = { 1e300 } });
  fail_unless(slow(0, 3) == 1h);
  const RiseTime quadratic;
  for (const double volts : { 100.0, 1e6, 1e100, 1e200, kInfinity }) {
    fail_unless(quadratic(0, volts) >= 0ns && quadratic(0, volts) <= 1h);
    fail_unless(quadratic(-volts, 3) >= 0ns && quadratic(-volts, 3) <= 1h);
  }
  fail_unless(quadratic(0, 1e6) == 1h);
}

CHECK_TEST(test_table)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inside(0.0, 1.0);
  for (const int size : { 1, 2, 3, 31 })
    for (const double step : { 0.1, 0.25, 1.7 }) {
      const RiseTimeTable table = random_table(size, step, static_cast<unsigned>(size));
      const RiseTime rise(table);
      for (int i = 0; i < 2000; i++) {
        // Up to a fifth beyond the grid on all sides
        const double reach = 1.4 * std::max(1.0, (size - 1) * step);
        double start = (inside(random) - 1.0 / 7) * reach;
        double target = (inside(random) - 1.0 / 7) * reach;
        if (start > target)
          std::swap(start, target);
        const double expected = target < 0.5 ? 0.0 : sum_of_hats(table, start, target);
        fail_unless_near(milliseconds(rise(start, target)), expected, 1e-6);
      }
    }
}

CHECK_TEST(test_table_points_and_edges)
{
  // Rows are start voltages, columns are targets, in steps of 1 V
  const RiseTimeTable table{ .step_volts = 1,
                             .size = 3,
                             .milliseconds = { 10, 20, 30, 40, 50, 60, 70, 80, 90 } };
  const RiseTime rise(table);
  fail_unless(rise(0, 1) == 20ms);
  fail_unless(rise(0, 2) == 30ms);
  fail_unless(rise(1, 2) == 60ms);
  fail_unless(rise(0.5, 1) == 35ms);   // between 20 and 50
  fail_unless(rise(0, 1.5) == 25ms);   // between 20 and 30
  fail_unless(rise(0.5, 1.5) == 40ms); // between 20, 30, 50 and 60
  fail_unless(rise(0, 5) == 30ms);
  fail_unless(rise(-3, 1) == 20ms);
  fail_unless(rise(4, 5) == 90ms);
  fail_unless(rise(1, 1e300) == 60ms);
  fail_unless(rise(1, kInfinity) == 60ms);
  const RiseTime copy = rise;
  fail_unless(copy(0.5, 1.5) == 40ms);
}

CHECK_TEST(test_wrong_tables)
{
  const RiseTimeTable good{ .step_volts = 0.5, .size = 2, .milliseconds = { 1, 2, 3, 0 } };
  fail_unless(fault_of(good).empty());
  RiseTimeTable largest{ .step_volts = 0.01, .size = 1024, .milliseconds = {} };
  largest.milliseconds.assign(1024 * 1024, 50.0);
  fail_unless(fault_of(largest).empty());

  const std::function<void(RiseTimeTable &)> faults[] = {
    [](RiseTimeTable &table) { table.size = 0, table.milliseconds.clear(); },
    [](RiseTimeTable &table) { table.size = -2; }, // its square would fit
    [](RiseTimeTable &table) { table.size = 1025, table.milliseconds.assign(1025 * 1025, 50.0); },
    [](RiseTimeTable &table) { table.size = 65536; }, // its square overflows
    [](RiseTimeTable &table) { table.milliseconds.pop_back(); },
    [](RiseTimeTable &table) { table.milliseconds.push_back(4); },
    [](RiseTimeTable &table) { table.milliseconds.clear(); },
    [](RiseTimeTable &table) { table.step_volts = 0; },
    [](RiseTimeTable &table) { table.step_volts = -0.1; },
    [](RiseTimeTable &table) { table.step_volts = kNan; },
    [](RiseTimeTable &table) { table.step_volts = kInfinity; },
    [](RiseTimeTable &table) { table.milliseconds[2] = -0.001; },
    [](RiseTimeTable &table) { table.milliseconds[3] = kNan; },
    [](RiseTimeTable &table) { table.milliseconds[0] = kInfinity; },
  };
  int number = 0;
  for (const auto &fault : faults) {
    RiseTimeTable table = good;
    fault(table);
    fail_if(fault_of(table).empty(), "fault %d was accepted", number);
    number++;
  }
  fail_if(fault_of(RiseTimeTable{}).empty());
}

CHECK_MAIN(rise_time)
