// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactor {

namespace {

constexpr int kLevels = 65; ///< points of a level curve
constexpr double kTableStepVolts = 0.1;
constexpr double kQuadraticVolts = 3.0; ///< beyond, the quadratic form extrapolates badly

/// Amplitude at a voltage: linear between points, from the origin to the first, constant after the
/// last.
double
amplitude_at(const std::vector<VibrationPoint> &points, double volts)
{
  VibrationPoint before;
  for (const VibrationPoint &point : points) {
    if (volts < point.volts)
      return std::lerp(before.amplitude, point.amplitude,
                       (volts - before.volts) / (point.volts - before.volts));
    before = point;
  }
  return before.amplitude;
}

/// The lowest voltage with this amplitude, or that of the last point if none reaches it.
double
volts_at(const std::vector<VibrationPoint> &points, double amplitude)
{
  VibrationPoint before;
  for (const VibrationPoint &point : points) {
    if (amplitude <= point.amplitude) {
      const double rise = point.amplitude - before.amplitude;
      return rise > 0 ? std::lerp(before.volts, point.volts, (amplitude - before.amplitude) / rise)
                      : before.volts;
    }
    before = point;
  }
  return before.volts;
}

/// None if there are only the paper's rise times.
std::optional<RiseTimeTable>
table_of(const TactorCalibration &tactor)
{
  if (tactor.quadratic && (tactor.prefers_quadratic || !tactor.table))
    return tactor.quadratic->table(kQuadraticVolts);
  return tactor.table;
}

} // namespace

double
QuadraticRiseTime::operator()(double start_volts, double offset_volts) const
{
  const double s = start_volts;
  const double d = offset_volts;
  const auto &c = coefficients;
  return c[0] + c[1] * d + c[2] * s + c[3] * d * d + c[4] * d * s + c[5] * s * s;
}

RiseTimeTable
QuadraticRiseTime::table(double volts_max) const
{
  RiseTimeTable table{ .step_volts = kTableStepVolts,
                       .size = static_cast<int>(std::ceil(volts_max / kTableStepVolts - 1e-9)) + 1,
                       .milliseconds = {} };
  for (int start = 0; start < table.size; start++)
    for (int target = 0; target < table.size; target++)
      table.milliseconds.push_back(
          std::max(0.0, (*this)(start * table.step_volts, (target - start) * table.step_volts)));
  return table;
}

RiseTime
TactorCalibration::rise_time() const
{
  std::optional<RiseTimeTable> best = table_of(*this);
  if (!best)
    return {};
  best->least_volts = std::min(hold_volts, start_volts);
  return RiseTime(std::move(*best));
}

std::vector<MotorParameters>
Calibration::motors(double volts_max) const
{
  double common = std::numeric_limits<double>::infinity();
  for (const auto &[index, tactor] : tactors)
    if (!tactor.vibration.empty())
      common = std::min(common, amplitude_at(tactor.vibration, volts_max));

  std::vector<MotorParameters> result;
  for (const auto &[index, tactor] : tactors) {
    result.resize(std::max(result.size(), static_cast<std::size_t>(index) + 1));
    MotorParameters &motor = result[static_cast<std::size_t>(index)];
    motor = { .rise_time = tactor.rise_time(),
              .start_volts = tactor.start_volts,
              .hold_volts = std::min(tactor.hold_volts, tactor.start_volts),
              .fall_time = tactor.fall_time,
              .latency = tactor.latency,
              .thresholds_measured = true };
    if (tactor.vibration.empty())
      continue;
    for (int i = 0; i < kLevels; i++) {
      const double level = static_cast<double>(i) / (kLevels - 1);
      const double amplitude = common * std::pow(level, 1 / perception_exponent);
      motor.level_volts.push_back(std::min(volts_at(tactor.vibration, amplitude), volts_max));
    }
  }
  return result;
}

Time
Calibration::longest_lead() const
{
  double longest = 0;
  for (const auto &[index, tactor] : tactors) {
    const double latency = static_cast<double>(tactor.latency.value_or(Time(0)).count()) / 1e6;
    const std::optional<RiseTimeTable> table = table_of(tactor);
    // Only start voltages below 90 % of the target: from others, nothing is left to rise.
    for (int start = 0; table && start < table->size; start++)
      for (int target = start + 1; target < table->size; target++) {
        const auto place = static_cast<std::size_t>(start) * static_cast<std::size_t>(table->size)
                           + static_cast<std::size_t>(target);
        if (target * table->step_volts >= tactor.start_volts && start < 0.9 * target)
          longest = std::max(longest, latency + table->milliseconds[place]);
      }
  }
  return Time(std::llround(longest * 1e6));
}

} // namespace tactor
