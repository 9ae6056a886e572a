// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace follow {

namespace {

/// Rounding of players: milliseconds, and a little.
constexpr double kRounding = 3e6;

/// The largest skew of clocks of sound cards, a second.
constexpr Time kLikelySkew = std::chrono::microseconds(200);

/// One in kOutliers reports may be too far ahead: at rate 1.25, mpv reports one frame in eight 16
/// ms early.
constexpr std::size_t kOutliers = 5;

/// Fewer reports say nothing of how densely they lie.
constexpr std::size_t kFew = 8;

/// Reports that show how densely they lie at a bound.
constexpr std::size_t kDensity = 4;

double
count(Time time)
{
  return static_cast<double>(time.count());
}

Time
time(double nanoseconds)
{
  return Time(std::llround(nanoseconds));
}

} // namespace

Evidence::Evidence(const Report &first, const Habits &habits)
    : habits_(habits), began_(first.received), position_(first.position.value_or(Time(0))),
      rate_(first.rate)
{
  add(first);
}

Evidence::Bounds
Evidence::bounds(const Report &report) const
{
  const Time earliest = report.asked.value_or(report.received - habits_.latest);
  const double position = count(report.position.value_or(position_) - position_);
  const double coarseness = count(habits_.coarseness) * (habits_.lingers ? rate_ : 1);
  return { .at = report.received,
           .low = position - rate_ * count(report.received - began_),
           .high = position + coarseness - rate_ * count(earliest - began_) };
}

/// The width that bounds have gained with age.
double
Evidence::age(const Bounds &bounds, Time now, Time skew) const
{
  return rate_ * 1e-9 * count(skew) * std::abs(count(now - bounds.at));
}

/// The highest lower bound but `rank`.
double
Evidence::low(Time now, std::size_t rank, Time skew) const
{
  std::vector<double> lows;
  lows.reserve(bounds_.size());
  for (const Bounds &one : bounds_)
    lows.push_back(one.low - age(one, now, skew));
  rank = std::min(rank, lows.size() - 1);
  std::ranges::nth_element(lows, lows.begin() + static_cast<std::ptrdiff_t>(rank),
                           std::greater<>());
  return lows[rank];
}

double
Evidence::high(Time now) const
{
  double least = std::numeric_limits<double>::infinity();
  for (const Bounds &one : bounds_)
    least = std::min(least, one.high + age(one, now, habits_.skew));
  return least;
}

Time
Evidence::misfit(const Report &report) const
{
  const Bounds its = bounds(report);
  if (const double ahead = its.low - high(report.received); ahead > 0)
    return time(ahead);
  if (const double behind = its.high - low(report.received, 0, habits_.skew); behind < 0)
    return time(behind);
  return Time(0);
}

bool
Evidence::fits(const Report &report) const
{
  return std::abs(count(misfit(report))) <= kRounding;
}

void
Evidence::add(const Report &report)
{
  asked_ = asked_ || report.asked.has_value();
  bounds_.push_back(bounds(report));
  if (bounds_.size() > kMost)
    bounds_.pop_front();
  // The rate is not quite what the player says: older reports contradict newer ones.
  while (bounds_.size() > 1
         && low(report.received, 0, habits_.skew) > high(report.received) + kRounding)
    bounds_.pop_front();
  offset_ = offset();
}

/// At the last report. Notified reports lie densely at their lower bound. A few may be wrong.
Evidence::Offset
Evidence::offset() const
{
  const Time last = bounds_.back().at;
  if (asked_) {
    const double least = low(last, 0, habits_.skew);
    const double most = high(last);
    double value = (least + most) / 2;
    if (habits_.lingers && bounds_.size() > kDensity)
      value = std::min(value,
                       least + (least - low(last, kDensity, habits_.skew)) / double{ kDensity });
    return { value, std::abs(most - least) / 2 };
  }
  const Time skew = std::min(habits_.skew, kLikelySkew);
  const std::size_t rank = bounds_.size() / kOutliers;
  const double value = low(last, rank, skew);
  return { value, bounds_.size() < kFew
                      ? count(habits_.latest + habits_.coarseness) / 2
                      : std::max(low(last, 0, skew) - value,
                                 value - low(last, rank + bounds_.size() / 16 + 2, skew))
                            + kRounding / 3 };
}

Time
Evidence::position(Time now) const
{
  return position_ + time(rate_ * count(now - began_) + offset_.value);
}

Time
Evidence::error(Time now) const
{
  return time(offset_.error + age(bounds_.back(), now, habits_.skew));
}

} // namespace follow
