// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/position_estimator.h"

#include <algorithm>
#include <cmath>

namespace follow {

namespace {

/// Spans between reports, by which the wait for the next one is set.
constexpr std::size_t kSpans = 8;

/// Any player may renew its position so late.
constexpr Time kRenewed = std::chrono::milliseconds(100);

Time
scaled(Time span, double by)
{
  return Time(std::llround(static_cast<double>(span.count()) * by));
}

bool
is_plausible(const Report &report)
{
  return std::isfinite(report.rate)
         && (!report.position
             || (*report.position >= Time(0)
                 && *report.position <= PositionEstimator::kLongestFilm));
}

} // namespace

PositionEstimator::PositionEstimator(const Settings &settings) : settings_(settings)
{
}

void
PositionEstimator::forget()
{
  stands_.reset();
  evidence_.reset();
  doubt_.reset();
  last_position_.reset();
  spans_.clear();
}

void
PositionEstimator::report(const Report &told)
{
  if (!is_plausible(told) || told.received < last_)
    return;
  const bool is_new_film = told.film != film_;
  const std::optional<Estimate> before = is_new_film ? std::nullopt : at(told.received);
  if (is_new_film) {
    forget();
    film_ = told.film;
  }
  const bool plays
      = told.doing == Doing::playing && told.rate >= kLeastRate && told.rate <= kMostRate;
  if (told.doing == Doing::stopped || (told.doing == Doing::playing && !plays)) {
    forget();
    return;
  }
  const Report report = with_position(told, before);
  if (!plays)
    stand(report);
  else if (!report.position || (!told.position && !evidence_))
    wait(report);
  else if (told.position && stands_still(told))
    stand(told);
  else if (!evidence_ || report.sought || report.rate != evidence_->rate())
    start(report, before);
  else if (told.position)
    follow(report);
  if (told.position || (plays && before))
    count_span(told.received);
  if (told.position) {
    last_ = told.received;
    if (told.position != last_position_)
      last_change_ = told.received;
    last_position_ = told.position;
  }
}

/// The position of a report that has none, such as a pause or another rate, is the estimate before
/// it.
Report
PositionEstimator::with_position(const Report &report, const std::optional<Estimate> &before) const
{
  Report whole = report;
  if (!whole.position && !whole.sought && before)
    whole.position = before->position;
  return whole;
}

void
PositionEstimator::stand(const Report &report)
{
  evidence_.reset();
  doubt_.reset();
  spans_.clear();
  if (report.position)
    stands_ = report.position;
}

/// Drops the position after a seek: it is unknown where the film continues.
void
PositionEstimator::wait(const Report &report)
{
  if (report.sought)
    forget();
}

/// While a film plays, its position does not repeat, but for rounding.
bool
PositionEstimator::stands_still(const Report &report) const
{
  if (!last_position_ || report.position != last_position_ || report.sought)
    return false;
  const Habits &habits = settings_.habits;
  const Time asked = report.asked.value_or(report.received - habits.latest);
  const Time renewed = scaled(habits.coarseness, habits.lingers ? 1 : 1 / report.rate);
  return asked - last_change_ > std::max(renewed, kRenewed) && (stands_ || evidence_);
}

void
PositionEstimator::start(const Report &report, std::optional<Estimate> before)
{
  const bool same_rate = evidence_ && evidence_->rate() == report.rate;
  stands_.reset();
  doubt_.reset();
  evidence_.emplace(report, settings_.habits);
  anchor_ = { report.received, evidence_->position(report.received) };
  // Another rate alone is no leap, nor is a position that is put right.
  bool goes_on = false;
  if (before && before->rate > 0) {
    const Time off = anchor_.position - before->position;
    const Time most = report.sought ? kPutRight : kLeap;
    goes_on = off > -most && off < most;
  }
  if (goes_on)
    anchor_.position = before->position;
  if (!goes_on || !same_rate)
    stretch_++;
}

void
PositionEstimator::follow(const Report &report)
{
  if (!evidence_->fits(report)) {
    doubt(report);
    return;
  }
  const std::optional<Estimate> before = at(report.received);
  doubt_.reset();
  evidence_->add(report);
  if (before) {
    anchor_ = { report.received, before->position };
  } else { // it is known again
    stretch_++;
    anchor_ = { report.received, evidence_->position(report.received) };
  }
}

void
PositionEstimator::doubt(const Report &report)
{
  if (!doubt_ || !doubt_->fits(report)) {
    const Time misfit = evidence_->misfit(report);
    leapt_ = misfit >= kLeap || misfit <= -kLeap;
    doubt_.emplace(report, settings_.habits);
    return;
  }
  doubt_->add(report);
  const std::optional<Estimate> before = at(report.received);
  const bool leapt = leapt_ || !before;
  evidence_ = std::move(doubt_);
  doubt_.reset();
  anchor_ = { report.received, evidence_->position(report.received) };
  if (leapt)
    stretch_++;
  else
    anchor_.position = before->position;
}

void
PositionEstimator::count_span(Time received)
{
  if (evidence_ && last_position_) {
    spans_.push_back(received - alive_);
    if (spans_.size() > kSpans)
      spans_.pop_front();
  }
  alive_ = received;
}

Time
PositionEstimator::told(Time now) const
{
  const double rate = evidence_->rate();
  const Time went = scaled(now - anchor_.at, rate);
  const Time off = evidence_->position(now) - anchor_.position - went;
  const Time most = scaled(went, kMostCorrection);
  return anchor_.position + went + std::clamp(off, -most, most);
}

std::optional<PositionEstimator::Estimate>
PositionEstimator::at(Time now) const
{
  if (stands_)
    return Estimate{ .position = *stands_, .rate = 0, .stretch = stretch_ };
  const std::optional<Time> until = known_until();
  if (!until || now > *until)
    return std::nullopt;
  const Time off = told(now) - evidence_->position(now);
  return Estimate{ .position = told(now),
                   .error = evidence_->error(now) + (off < Time(0) ? -off : off),
                   .rate = evidence_->rate(),
                   .stretch = stretch_ };
}

std::optional<Time>
PositionEstimator::known_until() const
{
  if (!evidence_ || (doubt_ && leapt_))
    return std::nullopt;
  const Time room = settings_.most_error - evidence_->error(last_);
  if (room < Time(0))
    return std::nullopt;
  Time longest = settings_.habits.most_patience / 3;
  if (!spans_.empty())
    longest = *std::ranges::max_element(spans_);
  const Time patience
      = std::clamp(3 * longest, settings_.habits.least_patience, settings_.habits.most_patience);
  const double widening = 1e-9 * static_cast<double>(settings_.habits.skew.count());
  return std::min(alive_ + patience, last_ + scaled(room, 1 / std::max(widening, 1e-9)));
}

bool
PositionEstimator::asks_again() const
{
  return doubt_.has_value() || (evidence_ && !known_until());
}

} // namespace follow
