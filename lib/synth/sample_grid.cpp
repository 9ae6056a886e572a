// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/sample_grid.h"

namespace synth {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// value · numerator / denominator, rounded down, for values of either sign. Whole seconds are
/// converted apart from the rest, so that years do not overflow.
std::int64_t
scale_down(std::int64_t value, std::int64_t numerator, std::int64_t denominator, std::int64_t round)
{
  std::int64_t whole = value / denominator;
  std::int64_t rest = value % denominator;
  if (rest < 0) {
    rest += denominator;
    whole--;
  }
  return whole * numerator + (rest * numerator + round) / denominator;
}

} // namespace

std::int64_t
SampleGrid::index_of(Time time) const
{
  return scale_down((time - origin).count(), rate, kSecond, kSecond / 2);
}

Time
SampleGrid::time_of(std::int64_t index) const
{
  return origin + Time(scale_down(index, kSecond, rate, 0));
}

} // namespace synth
