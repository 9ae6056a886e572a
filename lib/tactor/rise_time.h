// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <memory>
#include <string>
#include <vector>

namespace tactor {

/// Motors do not turn below this voltage (paper, Section 4: "less than a certain threshold (e.g.,
/// 0.5 V)").
inline constexpr double kStartVolts = 0.5;

/// The paper's Eq. 1: time in milliseconds from `start_volts` to 90 % of the steady-state vibration
/// of `start_volts + offset_volts`. The raw fit (R² = 0.98 on 0–3.0 V), neither clamped nor
/// monotonic.
double rise_time_quadratic_ms(double start_volts, double offset_volts);

/// Measured rise times of one motor on a regular grid of start and target volts, with bilinear
/// interpolation, clamped at the edges.
struct RiseTimeTable
{
  double step_volts = 0.1;          ///< spacing of both axes; both begin at 0 V
  int size = 0;                     ///< points per axis, 1…1024
  std::vector<double> milliseconds; ///< size × size, [start * size + target]
  double least_volts = kStartVolts; ///< the motor does not turn below
};

/// Why a table is invalid: its size or step, or a time that is negative or not finite. Empty if it
/// is valid.
std::string fault_of(const RiseTimeTable &table);

/// Rise time of a motor from one voltage to another. Copies share the table.
class RiseTime
{
public:
  /// The paper's Eq. 1.
  RiseTime() = default;
  /// A valid table, see fault_of().
  explicit RiseTime(RiseTimeTable table);

  /// Time from start to 90 % of target, from 0 to an hour. 0 where the motor does not accelerate
  /// (target ≤ start: "decelerating ones were within a frame"), and where the target is below
  /// kStartVolts, or the table's least_volts.
  Time operator()(double start_volts, double target_volts) const;

private:
  std::shared_ptr<const RiseTimeTable> table_; ///< null: the quadratic
};

} // namespace tactor
