// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstdint>
#include <vector>

namespace tactor {

/// Statistics of |issued − due| over any number of commands in bounded memory. Minimum, mean and
/// maximum are exact. A percentile is the upper edge of its 10 µs bin, from 1 s on the maximum. Not
/// thread-safe.
class ScheduleStatistics
{
public:
  static constexpr Time kBin = std::chrono::microseconds(10);

  void add(Time error);

  std::uint64_t count() const;
  Time min() const;
  Time mean() const;
  Time max() const;

  /// The percentile of `share` (0 to 1), up to a bin; 0 without values.
  Time percentile(double share) const;

private:
  std::vector<std::uint32_t> bins_; ///< up to that of the largest value, at most 1 s
  std::uint64_t count_ = 0;
  Time min_{ 0 };
  Time max_{ 0 };
  double sum_ = 0; ///< ns
};

} // namespace tactor
