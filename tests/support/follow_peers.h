// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What others make of the same reports.
#pragma once

#include "follow/report.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <vector>

/// The median of the last offsets between what was reported and when it came; they begin anew when
/// one is off by more than a second.
class MedianOfOffsets
{
public:
  void report(const follow::Report &report)
  {
    if (!report.position || report.doing != follow::Doing::playing)
      return;
    const follow::Time off = *report.position - at(report.received);
    if (report.sought || report.rate != rate_ || off > std::chrono::seconds(1)
        || off < -std::chrono::seconds(1))
      offsets_.clear();
    rate_ = report.rate;
    offsets_.push_back(static_cast<double>(report.position->count())
                       - rate_ * static_cast<double>(report.received.count()));
    if (offsets_.size() > kWindow)
      offsets_.pop_front();
  }
  follow::Time at(follow::Time now) const
  {
    std::vector<double> sorted(offsets_.begin(), offsets_.end());
    std::ranges::sort(sorted);
    const double offset = sorted.empty() ? 0 : sorted[sorted.size() / 2];
    return follow::Time(std::llround(rate_ * static_cast<double>(now.count()) + offset));
  }

private:
  static constexpr std::size_t kWindow = 21;
  double rate_ = 1;
  std::deque<double> offsets_;
};

/// As MultiFunPlayer 1.33 does it: goes a third of the way to each report, at once for more than a
/// second. What is played nears that by up to a tenth faster or slower, which is left out: it
/// follows within some tenths of a second.
class ThirdOfTheWay
{
public:
  void report(const follow::Report &report)
  {
    if (!report.position || report.doing != follow::Doing::playing)
      return;
    const follow::Time before = at(report.received);
    const follow::Time off = *report.position - before;
    const bool leaps = !knows_ || report.sought || off > std::chrono::seconds(1)
                       || off < -std::chrono::seconds(1);
    position_ = leaps
                    ? *report.position
                    : before + follow::Time(std::llround(0.33 * static_cast<double>(off.count())));
    at_ = report.received;
    rate_ = report.rate;
    knows_ = true;
  }
  follow::Time at(follow::Time now) const
  {
    return position_ + follow::Time(std::llround(rate_ * static_cast<double>((now - at_).count())));
  }

private:
  bool knows_ = false;
  double rate_ = 1;
  follow::Time at_{ 0 };
  follow::Time position_{ 0 };
};
