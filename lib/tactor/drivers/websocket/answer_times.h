// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <ranges>

namespace tactor {

/// How long a server takes to answer: the median of its last answers, so that single late ones do
/// not count.
class AnswerTimes
{
public:
  static constexpr std::size_t kWindow = 9;

  void add(Time took)
  {
    last_[count_++ % kWindow] = took;
  }
  /// The longer one of two in the middle; 0 before the first answer.
  Time median() const
  {
    if (count_ == 0)
      return Time(0);
    std::array<Time, kWindow> sorted = last_;
    std::ranges::fill(sorted | std::views::drop(count_), Time::max());
    std::ranges::sort(sorted);
    return sorted[std::min(count_, kWindow) / 2];
  }

private:
  std::array<Time, kWindow> last_{};
  std::size_t count_ = 0; ///< of all
};

} // namespace tactor
