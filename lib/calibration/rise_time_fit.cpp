// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/rise_time_fit.h"

#include "calibration/median.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace tactor {

namespace {

constexpr double kTableStepVolts = 0.1;
/// Distance at which the weight of a measurement's residual falls off.
constexpr double kNeighborVolts = 0.25;
/// Weight of a measured entry relative to an interpolated one.
constexpr double kMeasuredWeight = 100;
constexpr double kSameVolts = 1e-6;
constexpr double kWorstCondition = 1e-7;

/// The 97.5 % quantile of Student's t (Cornish-Fisher expansion; Abramowitz & Stegun 26.7.5).
double
student(int freedom)
{
  const double z = 1.959964;
  const double n = freedom;
  return z + (std::pow(z, 3) + z) / (4 * n)
         + (5 * std::pow(z, 5) + 16 * std::pow(z, 3) + 3 * z) / (96 * n * n)
         + (3 * std::pow(z, 7) + 19 * std::pow(z, 5) + 17 * std::pow(z, 3) - 15 * z)
               / (384 * n * n * n);
}

/// The fitted terms of the quadratic form; the others are 0.
constexpr std::array<std::size_t, 6> kAll{ 0, 1, 2, 3, 4, 5 };
constexpr std::array<std::size_t, 3> kOfOffset{ 0, 1, 3 };

/// None if the samples do not determine these terms, or are no more than they.
std::optional<QuadraticRiseTime>
fit(std::span<const RiseTimeSample> samples, std::span<const std::size_t> terms)
{
  const int count = static_cast<int>(samples.size());
  const int columns = static_cast<int>(terms.size());
  if (count <= columns)
    return std::nullopt;
  cv::Mat form(count, columns, CV_64F);
  cv::Mat times(count, 1, CV_64F);
  for (int i = 0; i < count; i++) {
    const RiseTimeSample &sample = samples[static_cast<std::size_t>(i)];
    const double s = sample.start_volts;
    const double d = sample.target_volts - sample.start_volts;
    const double row[] = { 1, d, s, d * d, d * s, s * s };
    for (int column = 0; column < columns; column++)
      form.at<double>(i, column) = row[terms[static_cast<std::size_t>(column)]];
    times.at<double>(i) = sample.milliseconds;
  }
  cv::Mat inverse;
  if (cv::invert(form.t() * form, inverse, cv::DECOMP_SVD) < kWorstCondition)
    return std::nullopt;
  cv::Mat solution;
  cv::solve(form, times, solution, cv::DECOMP_SVD);
  const cv::Mat left = times - form * solution;
  const double squares = left.dot(left);
  const cv::Mat spread = times - cv::mean(times)[0];
  const double total = spread.dot(spread);

  QuadraticRiseTime fit{ .r_squared = total > 0 ? 1 - squares / total : 1,
                         .residual_ms = std::sqrt(squares / count) };
  const int freedom = count - columns;
  for (int column = 0; column < columns; column++) {
    const std::size_t term = terms[static_cast<std::size_t>(column)];
    fit.coefficients[term] = solution.at<double>(column);
    fit.confidence[term]
        = student(freedom) * std::sqrt(squares / freedom * inverse.at<double>(column, column));
  }
  return fit;
}

} // namespace

std::optional<QuadraticRiseTime>
fit_quadratic(std::span<const RiseTimeSample> samples)
{
  return fit(samples, kAll);
}

std::vector<double>
isotonic(std::span<const double> values, std::span<const double> weights)
{
  struct Pool
  {
    double mean;
    double weight;
    std::size_t count;
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < values.size(); i++) {
    pools.push_back({ values[i], weights.empty() ? 1.0 : weights[i], 1 });
    while (pools.size() > 1 && pools[pools.size() - 2].mean > pools.back().mean) {
      const Pool last = pools.back();
      pools.pop_back();
      Pool &before = pools.back();
      before.mean
          = (before.mean * before.weight + last.mean * last.weight) / (before.weight + last.weight);
      before.weight += last.weight;
      before.count += last.count;
    }
  }
  std::vector<double> result;
  for (const Pool &pool : pools)
    result.insert(result.end(), pool.count, pool.mean);
  return result;
}

std::optional<RiseTimeTable>
monotone_table(std::span<const RiseTimeSample> samples, double volts_max)
{
  if (samples.empty())
    return std::nullopt;
  std::map<std::pair<double, double>, std::vector<double>> repeated;
  std::vector<double> all;
  for (const RiseTimeSample &sample : samples) {
    repeated[{ sample.start_volts, sample.target_volts }].push_back(sample.milliseconds);
    all.push_back(sample.milliseconds);
  }
  std::optional<QuadraticRiseTime> quadratic = fit_quadratic(samples);
  if (!quadratic) // measured from rest alone, or hardly
    quadratic = fit(samples, kOfOffset);
  const double middle = median(all);
  const auto trend = [&](double start, double target) {
    return quadratic ? (*quadratic)(start, target - start) : middle;
  };
  struct Known
  {
    double start;
    double target;
    double left; ///< residual of the trend
  };
  std::vector<Known> known;
  known.reserve(repeated.size());
  for (auto &[volts, times] : repeated)
    known.push_back(
        { volts.first, volts.second, median(times) - trend(volts.first, volts.second) });

  /// Interpolated residual: inverse distance weighting of the measurements.
  const auto left = [&](double start, double target) {
    double sum = 0;
    double weights = 0;
    for (const Known &point : known) {
      const double distance = std::hypot(point.start - start, point.target - target);
      if (distance < kSameVolts)
        return point.left;
      const double near = kNeighborVolts / distance;
      const double weight = std::pow(near, 4);
      sum += weight * point.left;
      weights += weight;
    }
    return sum / weights;
  };
  /// The quadratic extrapolates badly, so limit it to the measured range.
  const double earliest = *std::ranges::min_element(all);
  const double latest = *std::ranges::max_element(all);
  RiseTimeTable table{ .step_volts = kTableStepVolts,
                       .size = static_cast<int>(std::ceil(volts_max / kTableStepVolts - 1e-9)) + 1,
                       .milliseconds = {} };
  for (int row = 0; row < table.size; row++) {
    std::vector<double> sooner; // negative times, which rise with the target
    std::vector<double> weights;
    for (int column = 0; column < table.size; column++) {
      const double start = row * table.step_volts;
      const double target = column * table.step_volts;
      sooner.push_back(-std::clamp(trend(start, target) + left(start, target), earliest, latest));
      const bool measured = std::ranges::any_of(known, [&](const Known &point) {
        return std::hypot(point.start - start, point.target - target) < kSameVolts;
      });
      weights.push_back(measured ? kMeasuredWeight : 1);
    }
    // Targets not above the start are never looked up and must not affect the others.
    const auto from = std::min(static_cast<std::size_t>(row + 1), sooner.size() - 1);
    const std::vector<double> risen
        = isotonic(std::span(sooner).subspan(from), std::span(weights).subspan(from));
    for (std::size_t column = 0; column < sooner.size(); column++)
      table.milliseconds.push_back(-risen[column < from ? 0 : column - from]);
  }
  return table;
}

} // namespace tactor
