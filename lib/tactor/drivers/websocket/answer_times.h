// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <algorithm>
#include <array>
#include <cstddef>

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
  /// Of two in the middle the longer one; 0 before the first answer.
  Time median() const
  {
    std::array<Time, kWindow> sorted = last_;
    std::ranges::sort(sorted); // those that are unknown yet are 0, and come first
    const std::size_t known = std::min(count_, kWindow);
    return sorted[kWindow - known + known / 2 - (known == 0)];
  }

private:
  std::array<Time, kWindow> last_{};
  std::size_t count_ = 0;
};

} // namespace tactor
