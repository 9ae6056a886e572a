// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstdint>
#include <vector>

namespace tactor {

/// How exactly commands are issued: |issued − due| over any number of commands in bounded memory.
/// Minimum, mean and maximum are exact; a percentile is the upper edge of its 10 µs bin, from 1 s
/// on the maximum. Not thread-safe: its owner guards it.
class ScheduleStatistics
{
public:
  static constexpr Time kBin = std::chrono::microseconds(10);

  void add(Time error);

  std::uint64_t count() const;
  Time min() const;
  Time mean() const;
  Time max() const;

  /// The smallest value that at least `share` (0 to 1) of all values do not exceed, up to a bin; 0
  /// if there are none.
  Time percentile(double share) const;

private:
  std::vector<std::uint32_t> bins_; ///< as long as the largest value needs, at most 1 s
  std::uint64_t count_ = 0;
  Time min_{ 0 };
  Time max_{ 0 };
  double sum_ = 0; ///< ns
};

} // namespace tactor
