// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/rise_time.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

namespace tactor {

namespace {

constexpr int kMaxTableSize = 1024;
constexpr double kLongestMs = 3.6e6;

double
interpolate(const RiseTimeTable &table, double start_volts, double target_volts)
{
  const double last = table.size - 1;
  const double row = std::clamp(start_volts / table.step_volts, 0.0, last);
  const double column = std::clamp(target_volts / table.step_volts, 0.0, last);
  const int row0 = static_cast<int>(row);
  const int column0 = static_cast<int>(column);
  const int row1 = std::min(row0 + 1, table.size - 1);
  const int column1 = std::min(column0 + 1, table.size - 1);
  const auto at = [&table](int r, int c) {
    return table.milliseconds[static_cast<std::size_t>(r) * table.size + c];
  };
  const double upper = std::lerp(at(row0, column0), at(row0, column1), column - column0);
  const double lower = std::lerp(at(row1, column0), at(row1, column1), column - column0);
  return std::lerp(upper, lower, row - row0);
}

} // namespace

double
rise_time_quadratic_ms(double start_volts, double offset_volts)
{
  const double s = start_volts;
  const double d = offset_volts;
  return 241.9 - 175.7 * d - 117.7 * s + 38.86 * d * d + 49.59 * d * s + 18.07 * s * s;
}

std::string
fault_of(const RiseTimeTable &table)
{
  if (table.size < 1 || table.size > kMaxTableSize)
    return "a rise time table has 1 to " + std::to_string(kMaxTableSize) + " points per axis, not "
           + std::to_string(table.size);
  const std::size_t expected = static_cast<std::size_t>(table.size) * table.size;
  if (table.milliseconds.size() != expected)
    return "a rise time table of " + std::to_string(table.size) + " points per axis has "
           + std::to_string(expected) + " times, not " + std::to_string(table.milliseconds.size());
  if (!std::isfinite(table.step_volts) || table.step_volts <= 0)
    return "the step of a rise time table is a positive number of volts";
  if (!std::isfinite(table.least_volts) || table.least_volts < 0)
    return "the least volts of a rise time table are finite and not negative";
  if (!std::ranges::all_of(table.milliseconds,
                           [](double ms) { return std::isfinite(ms) && ms >= 0; }))
    return "the times of a rise time table are finite and not negative";
  return {};
}

RiseTime::RiseTime(RiseTimeTable table)
    : table_(std::make_shared<const RiseTimeTable>(std::move(table)))
{
  assert(fault_of(*table_).empty());
}

Time
RiseTime::operator()(double start_volts, double target_volts) const
{
  // Also true for NaN.
  const double least = table_ ? table_->least_volts : kStartVolts;
  if (!(target_volts > start_volts) || target_volts < least)
    return Time(0);
  const double ms = table_ ? interpolate(*table_, start_volts, target_volts)
                           : rise_time_quadratic_ms(start_volts, target_volts - start_volts);
  if (!(ms > 0))
    return Time(0);
  return Time(std::llround(std::min(ms, kLongestMs) * 1e6));
}

} // namespace tactor
