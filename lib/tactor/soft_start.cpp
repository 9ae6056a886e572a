// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/soft_start.h"

#include <algorithm>

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
  if (!armed_)
    return false;
  armed_ = false;
  if (length_ > Time(0))
    begin_ = now;
  return begin_.has_value();
}

double
SoftStart::ceiling(Time now) const
{
  if (!begin_ || length_ <= Time(0))
    return 1;
  const double steps = static_cast<double>((now - *begin_) / kStep + 1);
  return std::min(
      steps * static_cast<double>(Time(kStep).count()) / static_cast<double>(length_.count()), 1.0);
}

std::optional<Time>
SoftStart::next_step(Time now) const
{
  if (ceiling(now) >= 1)
    return std::nullopt;
  return *begin_ + ((now - *begin_) / kStep + 1) * kStep;
}

} // namespace tactor
