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
SoftStart::vibrate(Time now, Time update)
{
  const bool begins = std::exchange(armed_, false) && length_ > Time(0);
  if (begins || (begin_ && now < *begin_))
    begin_ = step_begin_ = now;
  else if (!begin_ || now < step_begin_ + step_)
    return false;
  else
    step_begin_ = step_end(now) - step_;
  step_ = std::max(Time(kStep), update);
  return begins;
}

double
SoftStart::ceiling(Time now) const
{
  if (!begin_ || length_ <= Time(0))
    return 1;
  const auto risen = static_cast<double>((step_end(now) - *begin_).count());
  return std::min(risen / static_cast<double>(length_.count()), 1.0);
}

std::optional<Time>
SoftStart::next_step(Time now) const
{
  if (ceiling(now) >= 1)
    return std::nullopt;
  return step_end(now);
}

Time
SoftStart::step_end(Time now) const
{
  return step_begin_ + (std::max(now - step_begin_, Time(0)) / step_ + 1) * step_;
}

} // namespace tactor
