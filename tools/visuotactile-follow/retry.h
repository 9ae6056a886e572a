// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <algorithm>

/// Says when to try again what failed: after 2 s, then each time after twice as long, up to a
/// minute. Reads no clock.
class Retry
{
public:
  bool is_due(follow::Time now) const
  {
    return now >= next_;
  }
  void failed(follow::Time now)
  {
    wait_ = std::clamp<follow::Time>(2 * wait_, kLeast, kMost);
    next_ = now + wait_;
  }
  void worked()
  {
    wait_ = follow::Time(0);
  }

private:
  static constexpr follow::Time kLeast = std::chrono::seconds(2);
  static constexpr follow::Time kMost = std::chrono::minutes(1);

  follow::Time wait_{ 0 };
  follow::Time next_{ 0 };
};
