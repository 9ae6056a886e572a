// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/cue_limiter.h"

#include <algorithm>

namespace tactile {

bool
CueLimiter::Cell::begin_cue(Time time, const CueLimits &limits)
{
  if (end && time - *end < limits.refractory)
    return false;
  state = State::cue;
  begin = time;
  return true;
}

bool
CueLimiter::Cell::is_felt(float level, Time time, const CueLimits &limits)
{
  const bool limited = limits.max_duration > Time::zero();

  if (state != State::at_rest && silent_since && time - *silent_since >= kShortestRest) {
    if (state == State::cue)
      end = *silent_since;
    state = State::at_rest;
  }
  if (!(level > 0)) {
    if (!silent_since)
      silent_since = time;
    return false;
  }
  silent_since.reset();

  switch (state) {
  case State::at_rest:
    return begin_cue(time, limits);
  case State::cue:
    if (!limited || time - begin < limits.max_duration)
      return true;
    state = State::spent;
    end = begin + limits.max_duration;
    lowest = level;
    return false;
  case State::spent:
    lowest = std::min(lowest, level);
    if (!limited || level >= kStrongerRatio * std::max(lowest, kFaintLevel))
      return begin_cue(time, limits);
    return false;
  }
  return false;
}

void
CueLimiter::limit(TactileMap &map, Time time, const CueLimits &limits)
{
  if ((last_time_ && time < *last_time_) || cells_.size() != map.levels.size()
      || columns_ != map.columns)
    reset();
  cells_.resize(map.levels.size());
  columns_ = map.columns;
  last_time_ = time;
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (!cells_[i].is_felt(map.levels[i], time, limits))
      map.levels[i] = 0;
}

void
CueLimiter::reset()
{
  cells_.clear();
  last_time_.reset();
}

} // namespace tactile
