// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/bhaptics_answers.h"

#include <algorithm>
#include <utility>

namespace tactor {

BhapticsAnswers::BhapticsAnswers(std::vector<std::string_view> positions, Times times)
    : positions_(std::move(positions)), times_(times)
{
}

void
BhapticsAnswers::begin()
{
  playing_.clear();
  is_change_ = lists_ = speaks_unasked_ = may_be_answered_ = has_answered_ = false;
  under_way_.clear();
  sent_at_ = overdue_at_ = Time(0);
  first_at_.reset();
  waits_since_.reset();
  certain_.reset();
  took_ = {};
}

void
BhapticsAnswers::sent(std::vector<std::string_view> playing, Time now)
{
  forget(now);
  if (may_be_answered_ && now >= ready_at())
    under_way_.clear();
  is_change_ = under_way_.empty() && playing != playing_;
  playing_ = std::move(playing);
  may_be_answered_ = false;
  under_way_.push_back(now);
  sent_at_ = now;
  overdue_at_ = now + overdue();
  first_at_ = first_at_.value_or(now);
  waits_since_ = waits_since_.value_or(now);
}

void
BhapticsAnswers::heard(const bhaptics::Status &status, Time now)
{
  waits_since_.reset();
  lists_ = lists_ || lists(status);
  forget(now);
  if (under_way_.empty()) {
    if (first_at_ && !std::exchange(speaks_unasked_, true))
      took_ = {}; // some of them may have been no answers
    return;
  }
  has_answered_ = true;
  const Time took = now - sent_at_;
  if (is_change_ && lists_) {
    if (!shows_last(status))
      return;
    certain_ = took;
    took_.add(took);
    under_way_.clear();
    return;
  }
  if (speaks_unasked_ && took < certain_.value_or(times_.shortest)) {
    may_be_answered_ = true;
    return;
  }
  // If several are under way, the oldest one: a server that became slow is sent less.
  if (!speaks_unasked_)
    took_.add(now - under_way_.front());
  under_way_.pop_front();
}

Time
BhapticsAnswers::ready_at() const
{
  if (under_way_.empty())
    return sent_at_;
  if (!has_answered_)
    return sent_at_ + times_.renewal;
  // An earlier message would wait at the server.
  if (may_be_answered_ && certain_)
    return std::min(sent_at_ + *certain_ * 5 / 4, overdue_at_);
  return overdue_at_;
}

bool
BhapticsAnswers::is_quick() const
{
  return took_.median() <= times_.quick;
}

Time
BhapticsAnswers::duration() const
{
  return overdue() + times_.slack;
}

std::optional<Time>
BhapticsAnswers::waits_since() const
{
  return waits_since_;
}

bool
BhapticsAnswers::has_answered() const
{
  return has_answered_;
}

std::optional<Time>
BhapticsAnswers::listens_until() const
{
  return first_at_ ? std::optional(*first_at_ + times_.listening) : std::nullopt;
}

Time
BhapticsAnswers::latency() const
{
  return took_.median();
}

bool
BhapticsAnswers::lists(const bhaptics::Status &status) const
{
  return std::ranges::any_of(positions_, [&](std::string_view position) {
    return std::ranges::find(status.playing, position) != status.playing.end();
  });
}

/// Whether the positions are on and off as the last message has them.
bool
BhapticsAnswers::shows_last(const bhaptics::Status &status) const
{
  return std::ranges::all_of(positions_, [&](std::string_view position) {
    const bool is_on = std::ranges::find(status.playing, position) != status.playing.end();
    return is_on == (std::ranges::find(playing_, position) != playing_.end());
  });
}

void
BhapticsAnswers::forget(Time now)
{
  while (!under_way_.empty() && now >= under_way_.front() + times_.forgotten)
    under_way_.pop_front();
}

Time
BhapticsAnswers::overdue() const
{
  return std::clamp(2 * took_.median(), times_.shortest, times_.longest);
}

} // namespace tactor
