// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/rise_time_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace tactor;

namespace {

/// Eq. 1 as printed, for 1, d, s, d², d·s, s².
constexpr std::array<double, 6> kPrinted = { 241.9, -175.7, -117.7, 38.86, 49.59, 18.07 };

/// The paper's grid: start voltages and offsets from 0 to 3.0 V in steps of 0.1 V, within 3.0 V.
std::vector<RiseTimeSample>
papers_grid(double noise_ms = 0, unsigned seed = 3)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_ms > 0 ? noise_ms : 1);
  std::vector<RiseTimeSample> samples;
  for (int start = 0; start < 30; start++)
    for (int target = start + 1; target <= 30; target++) {
      const double ms = rise_time_quadratic_ms(0.1 * start, 0.1 * (target - start));
      samples.push_back({ 0.1 * start, 0.1 * target, ms + (noise_ms > 0 ? noise(random) : 0) });
    }
  return samples;
}

} // namespace

CHECK_TEST(papers_equation_is_recovered_to_its_printed_digits)
{
  const auto fit = fit_quadratic(papers_grid());
  fail_unless(fit.has_value());
  for (std::size_t i = 0; i < kPrinted.size(); i++) {
    fail_unless_near(fit->coefficients[i], kPrinted[i], 0.0005);
    fail_unless_at_most(fit->confidence[i], 1e-6);
  }
  fail_unless_near(fit->r_squared, 1, 1e-9);
  fail_unless_near((*fit)(0.5, 1.5), rise_time_quadratic_ms(0.5, 1.5), 1e-6);
}

// With noise that matches the paper's R² of 0.98, 95 of 100 confidence intervals contain the true
// value.
CHECK_TEST(confidence_intervals_contain_the_truth)
{
  constexpr int kTimes = 400;
  std::array<int, 6> within{};
  for (unsigned seed = 1; seed <= kTimes; seed++) {
    const auto fit = fit_quadratic(papers_grid(6, seed));
    fail_unless(fit.has_value());
    for (std::size_t i = 0; i < kPrinted.size(); i++)
      within[i] += std::abs(fit->coefficients[i] - kPrinted[i]) <= fit->confidence[i];
    fail_unless_near(fit->residual_ms, 6, 0.8);
    fail_unless(fit->r_squared > 0.96 && fit->r_squared < 0.996);
  }
  for (const int count : within)
    fail_unless_near(static_cast<double>(count) / kTimes, 0.95, 0.035);
}

CHECK_TEST(too_few_samples_give_no_fit)
{
  std::vector<RiseTimeSample> samples = papers_grid();
  samples.resize(6);
  fail_if(fit_quadratic(samples).has_value());
  // Many samples, but all from rest.
  samples = papers_grid();
  std::erase_if(samples, [](const RiseTimeSample &sample) { return sample.start_volts > 0; });
  fail_if(fit_quadratic(samples).has_value());
  fail_if(fit_quadratic({}).has_value());
}

// Against the minimax formula for isotonic regression: max over i ≤ k of min over j ≥ k of
// mean(i…j).
CHECK_TEST(isotonic_is_the_nearest_rising_sequence)
{
  std::mt19937 random(5);
  std::uniform_int_distribution<int> value(0, 9);
  for (int round = 0; round < 200; round++) {
    std::vector<double> values(1 + static_cast<std::size_t>(round % 12));
    for (double &v : values)
      v = value(random);
    const std::vector<double> got = isotonic(values);
    fail_unless(got.size() == values.size());
    for (std::size_t k = 0; k < values.size(); k++) {
      double highest = -1;
      for (std::size_t i = 0; i <= k; i++) {
        double lowest = 100;
        double sum = 0;
        for (std::size_t j = i; j < values.size(); j++) {
          sum += values[j];
          if (j >= k)
            lowest = std::min(lowest, sum / static_cast<double>(j - i + 1));
        }
        highest = std::max(highest, lowest);
      }
      fail_unless_near(got[k], highest, 1e-9);
    }
  }
}

CHECK_TEST(table_contains_the_samples_and_is_monotonic)
{
  const auto truth = [](double start, double target) {
    return 20 + 150 * std::exp(-(target + 0.3 * start) / 0.8);
  };
  std::vector<RiseTimeSample> samples;
  for (int start = 0; start <= 5; start++)
    for (int target = start + 1; target <= 6; target++)
      for (const double noise : { -1.0, 0.0, 40.0 }) // their median is the truth
        samples.push_back({ 0.5 * start, 0.5 * target, truth(0.5 * start, 0.5 * target) + noise });
  const RiseTimeTable table = *monotone_table(samples, 3.0);
  fail_unless(table.size == 31);
  const RiseTime rise_time(table);
  for (int start = 0; start <= 5; start++)
    for (int target = start + 1; target <= 6; target++)
      fail_unless_near(static_cast<double>(rise_time(0.5 * start, 0.5 * target).count()) / 1e6,
                       truth(0.5 * start, 0.5 * target), 0.1);
  for (int start = 0; start < 31; start++)
    for (int target = start + 2; target < 31; target++)
      fail_unless(table.milliseconds[static_cast<std::size_t>(start * 31 + target)]
                  <= table.milliseconds[static_cast<std::size_t>(start * 31 + target - 1)] + 1e-9);
}

// What one run of a measurement has: rises from rest to 0.4 to 1 V and to 1.5 V. In between
// the table is that of the motor.
CHECK_TEST(table_of_rises_from_rest_alone)
{
  std::vector<RiseTimeSample> samples;
  for (const int tenth : { 4, 5, 6, 7, 8, 9, 10, 15 })
    samples.push_back({ 0, 0.1 * tenth, rise_time_quadratic_ms(0, 0.1 * tenth) });
  const auto table = monotone_table(samples, 1.5);
  fail_unless(table.has_value());
  const RiseTime rise_time(*table);
  for (int hundredth = 50; hundredth <= 150; hundredth++) {
    const double volts = 0.01 * hundredth;
    const double ms = static_cast<double>(rise_time(0, volts).count()) / 1e6;
    fail_unless_near(ms, rise_time_quadratic_ms(0, volts), 0.2); // linear within 0.1 V
  }
}

CHECK_TEST(no_samples_give_no_table)
{
  fail_if(monotone_table({}, 3.0));
}

CHECK_MAIN(rise_time_fit)
