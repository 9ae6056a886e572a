// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <memory>
#include <string>
#include <vector>

namespace tactor {

/// Motors below this voltage do not turn (paper, Section 4: "less than a certain threshold (e.g.,
/// 0.5 V)").
inline constexpr double kStartVolts = 0.5;

/// The paper's Eq. 1: time in milliseconds from `start_volts` to 90 % of the steady-state vibration
/// of `start_volts + offset_volts`, the raw fit: neither clamped nor monotone (R² = 0.98 on
/// 0–3.0 V).
double rise_time_quadratic_ms(double start_volts, double offset_volts);

/// Measured rise times of one motor on a regular grid of start and target volts; bilinear in
/// between, clamped to the grid's edges outside.
struct RiseTimeTable
{
  double step_volts = 0.1;          ///< spacing of both axes; both begin at 0 V
  int size = 0;                     ///< points per axis, 1…1024
  std::vector<double> milliseconds; ///< size × size, [start * size + target]
  double least_volts = kStartVolts; ///< the motor does not turn below
};

/// Why that is no table: its size or step does not fit, or a time is negative or not finite. Empty
/// if it is one.
std::string fault_of(const RiseTimeTable &table);

/// How long a motor needs to rise from one voltage to another. Copies share the table.
class RiseTime
{
public:
  /// The paper's quadratic.
  RiseTime() = default;
  /// A calibrated table, one without fault_of().
  explicit RiseTime(RiseTimeTable table);

  /// Time from start to 90 % of target, at least 0. Zero where the motor does not accelerate
  /// (target ≤ start: "decelerating ones were within a frame") and where the target is below
  /// kStartVolts, or the table's least_volts. Never more than an hour, whatever the fit makes of
  /// volts far outside its range.
  Time operator()(double start_volts, double target_volts) const;

private:
  std::shared_ptr<const RiseTimeTable> table_; ///< null: the quadratic
};

} // namespace tactor
