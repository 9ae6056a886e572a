// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/soft_start.h"

#include <algorithm>
#include <utility>

namespace tactor {

void
SoftStart::set_length(Time length)
{
  length_ = length;
}

void
SoftStart::arm()
{
  armed_ = true;
  begin_.reset();
}

bool
SoftStart::vibrate(Time now)
{
  const bool begins = std::exchange(armed_, false) && length_ > Time(0);
  if (begins || (begin_ && now < *begin_))
    begin_ = now;
  return begins;
}

double
SoftStart::ceiling(Time now) const
{
  if (!begin_ || length_ <= Time(0))
    return 1;
  const double steps = static_cast<double>(std::max(now - *begin_, Time(0)) / kStep + 1);
  return std::min(
      steps * static_cast<double>(Time(kStep).count()) / static_cast<double>(length_.count()), 1.0);
}

std::optional<Time>
SoftStart::next_step(Time now) const
{
  if (ceiling(now) >= 1)
    return std::nullopt;
  return *begin_ + (std::max(now - *begin_, Time(0)) / kStep + 1) * kStep;
}

} // namespace tactor
