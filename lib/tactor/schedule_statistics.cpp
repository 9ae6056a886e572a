// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/schedule_statistics.h"

#include <algorithm>
#include <cmath>

namespace tactor {

namespace {

constexpr Time kLongest = std::chrono::seconds(1);

} // namespace

void
ScheduleStatistics::add(Time error)
{
  const Time value = error < Time(0) ? -std::max(error, -Time::max()) : error;
  min_ = count_ ? std::min(min_, value) : value;
  max_ = std::max(max_, value);
  sum_ += static_cast<double>(value.count());
  count_++;
  if (value < kLongest) {
    const auto bin = static_cast<std::size_t>(value / kBin);
    if (bin >= bins_.size())
      bins_.resize(bin + 1);
    bins_[bin]++;
  }
}

std::uint64_t
ScheduleStatistics::count() const
{
  return count_;
}

Time
ScheduleStatistics::min() const
{
  return min_;
}

Time
ScheduleStatistics::mean() const
{
  return Time(count_ ? std::llround(sum_ / static_cast<double>(count_)) : 0);
}

Time
ScheduleStatistics::max() const
{
  return max_;
}

Time
ScheduleStatistics::percentile(double share) const
{
  const double wanted = std::max(1.0, std::ceil(share * static_cast<double>(count_)));
  double seen = 0;
  for (std::size_t bin = 0; bin < bins_.size(); bin++) {
    seen += bins_[bin];
    if (seen >= wanted)
      return std::min(max_, kBin * static_cast<Time::rep>(bin + 1));
  }
  return max_;
}

} // namespace tactor
