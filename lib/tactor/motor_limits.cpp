// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/motor_limits.h"

#include <algorithm>

namespace tactor {

MotorUse::End
MotorUse::latest_end(Time begin, const MotorLimits &limits) const
{
  End end;
  if (limits.max_on_time > Time(0))
    end = { std::max(begin, cue_begin(begin) + limits.max_on_time), Limit::on_time };
  if (limits.max_duty > 0 && limits.max_duty < 1) {
    const Time allowed(
        static_cast<Time::rep>(limits.max_duty * static_cast<double>(Time(kDutyWindow).count())));
    const Time time = duty_end(begin, allowed);
    if (time < end.time)
      end = { time, Limit::duty };
  }
  return end;
}

/// Begin of the cue to which a stretch from `begin` on belongs.
Time
MotorUse::cue_begin(Time begin) const
{
  return !past_.empty() && begin - past_.back().end < shortest_rest_ ? past_.back().cue : begin;
}

/// The latest end of a stretch from `begin` on such that no window has more than `allowed`.
Time
MotorUse::duty_end(Time begin, Time allowed) const
{
  Time left = allowed;
  for (const Stretch &stretch : past_)
    left -= std::max(stretch.end - std::max(stretch.begin, begin - kDutyWindow), Time(0));

  // The window ends where the stretch does. While an old stretch leaves the window as fast as the
  // new one enters it, the sum stays the same.
  Time end = begin;
  for (const Stretch &stretch : past_) {
    if (stretch.end + kDutyWindow <= end)
      continue;
    const Time used = std::max(stretch.begin + kDutyWindow - end, Time(0));
    if (left < used)
      break;
    left -= used;
    end = stretch.end + kDutyWindow;
  }
  return end + std::max(left, Time(0));
}

bool
MotorUse::is_on() const
{
  return on_since_.has_value();
}

Time
MotorUse::on_since() const
{
  return *on_since_;
}

Time
MotorUse::off_since() const
{
  if (is_on())
    return Time::max();
  return past_.empty() ? Time::min() : past_.back().end;
}

Time
MotorUse::ready_at() const
{
  return ready_at_;
}

void
MotorUse::begin(Time time)
{
  on_since_ = time;
  while (!past_.empty() && past_.front().end <= time - kDutyWindow)
    past_.pop_front();
}

void
MotorUse::end(Time time, bool limited)
{
  past_.push_back({ cue_begin(*on_since_), *on_since_, time });
  on_since_.reset();
  ready_at_ = limited ? time + shortest_rest_ : time;
  if (past_.size() > kMostStretches) {
    past_[1].begin = past_[0].begin;
    past_.pop_front();
  }
}

void
MotorUse::forget_from(Time time)
{
  if (is_on())
    end(std::max(time, *on_since_), false);
  while (!past_.empty() && past_.back().begin >= time)
    past_.pop_back();
  if (!past_.empty())
    past_.back().end = std::min(past_.back().end, time);
}

void
MotorUse::age(Time by)
{
  for (Stretch &stretch : past_) {
    stretch.cue -= by;
    stretch.begin -= by;
    stretch.end -= by;
  }
  if (ready_at_ != Time::min())
    ready_at_ -= by;
}

} // namespace tactor
