// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactoractuation.h"

#include <algorithm>
#include <utility>

using tactor::Command;
using tactor::Time;

/// The tactors that are not at zero.
static std::vector<std::size_t>
vibrating(std::span<const double> levels)
{
  std::vector<std::size_t> tactors;
  for (std::size_t i = 0; i < levels.size(); i++)
    if (levels[i] != 0)
      tactors.push_back(i);
  return tactors;
}

void
TactorActuation::start(double full_scale_volts)
{
  full_scale_volts_ = full_scale_volts;
  queue_ = tactor::CommandQueue(0);
  sent_.clear();
  counters_ = {};
  expires_.reset();
  refresh_.reset();
  starved_.reset();
  short_lead_.reset();
  soft_start_.arm();
}

void
TactorActuation::open(const tactor::Driver &driver, std::unique_ptr<tactor::CommandTrace> trace)
{
  trace_ = std::move(trace);
  refresh_interval_ = driver.refresh_interval();
  line_ = driver.line();
  queue_ = tactor::CommandQueue(driver.tactors());
  open_ = true;
}

void
TactorActuation::close()
{
  flush_trace();
  trace_.reset();
  open_ = false;
}

bool
TactorActuation::push(std::span<const Command> commands, Time expires, Time now)
{
  std::vector<Command> known(commands.begin(), commands.end());
  for (Command &command : known)
    command.known = now;
  const std::optional<Time> before = queue_.next_due();
  queue_.push(known);
  const std::optional<Time> next = queue_.next_due();
  const bool was_idle = !before && !expires_;
  expires_ = expires;
  return was_idle || (next && (!before || *next < *before));
}

void
TactorActuation::clear()
{
  counters_.dropped += queue_.clear();
  expires_.reset();
  starved_.reset();
  soft_start_.arm();
}

void
TactorActuation::set_ramp_in(Time length)
{
  soft_start_.set_length(length);
}

std::optional<Time>
TactorActuation::next(Time running) const
{
  std::optional<Time> earliest;
  for (const std::optional<Time> &next :
       { queue_.next_due(), expires_, refresh_, soft_start_.next_step(running) })
    if (next)
      earliest = std::min(*next, earliest.value_or(*next));
  return earliest;
}

std::size_t
TactorActuation::pending() const
{
  return queue_.size();
}

std::optional<TactorActuation::Step>
TactorActuation::take_due(const Now &now)
{
  if (!now.timed)
    expires_.reset();
  // Not issued late: a film that is behind would shake the chair.
  if (expires_ && *expires_ <= now.running)
    return starve(now);
  const std::optional<Time> due = queue_.next_due();
  if (!due || (now.timed ? *due > now.running : queue_.size() == 0))
    return std::nullopt;
  Step step{ .running = now.timed ? now.running : *due };
  step.commands = queue_.take_due(step.running);
  counters_.issued += step.commands.size();
  if (now.timed)
    count(step);
  return with_volts(now, std::move(step));
}

bool
TactorActuation::needs_update(const Now &now) const
{
  return (refresh_ && *refresh_ <= now.running)
         || (now.timed && open_ && soft_start_.ceiling(now.running) != ceiling_);
}

TactorActuation::Step
TactorActuation::update(const Now &now)
{
  return with_volts(now, { .running = now.running });
}

void
TactorActuation::written(const Step &step)
{
  trace(step.running, step.commands, *step.volts);
  sent_ = *step.volts;
  refresh_.reset();
  if (refresh_interval_ > Time(0) && std::ranges::any_of(sent_, [](double v) { return v != 0; }))
    refresh_ = step.running + refresh_interval_;
}

void
TactorActuation::failed(Time running)
{
  trace(running, {}, std::vector<double>(sent_.size(), 0.0)); // no motor runs on
  sent_.clear();
  refresh_.reset();
  soft_start_.arm();
  open_ = false;
}

std::optional<Time>
TactorActuation::refresh_interval() const
{
  return refresh_ ? std::optional(refresh_interval_) : std::nullopt;
}

void
TactorActuation::refresh_by(Time running)
{
  if (refresh_)
    refresh_ = std::min(*refresh_, running);
}

std::optional<Time>
TactorActuation::take_starved()
{
  return std::exchange(starved_, std::nullopt);
}

std::optional<TactorActuation::ShortLead>
TactorActuation::take_short_lead()
{
  return std::exchange(short_lead_, std::nullopt);
}

TactorActuation::Counters
TactorActuation::counters() const
{
  Counters counters = counters_;
  counters.coalesced = queue_.coalesced();
  return counters;
}

void
TactorActuation::flush_trace()
{
  if (trace_)
    trace_->flush();
}

bool
TactorActuation::trace_failed() const
{
  return trace_ && trace_->failed();
}

/// The last map has expired: all motors to zero, and what is due only now is dropped.
TactorActuation::Step
TactorActuation::starve(const Now &now)
{
  std::optional<Command> stale; // the earliest
  const std::size_t dropped = queue_.drop_due(now.running, stale);
  std::vector<Command> zeros;
  const std::span<const double> levels = queue_.levels();
  for (std::size_t i = 0; i < levels.size(); i++)
    if (levels[i] > 0)
      zeros.push_back(
          { .effect = *expires_, .lead = Time(0), .tactor = static_cast<int>(i), .volts = 0 });
  expires_.reset();
  Step step{ .running = now.running };
  if (zeros.empty() && !stale)
    return step;
  counters_.dropped += dropped;
  counters_.expired += dropped;
  counters_.starved += std::ranges::any_of(sent_, [](double volts) { return volts != 0; });
  starved_ = now.running;
  queue_.push(zeros);
  step.commands = queue_.take_due(now.running);
  if (stale)
    note({ .lead = stale->lead, .late = now.running - stale->due() });
  return with_volts(now, std::move(step));
}

/// Counts how late the commands of a timed step are.
void
TactorActuation::count(const Step &step)
{
  ShortLead latest{};
  for (const Command &command : step.commands) {
    const Time late = step.running - command.due();
    counters_.error.add(late);
    counters_.late += late > kLate;
    counters_.came_late += command.known > command.due();
    const Time waited = step.running - std::max(command.due(), command.known);
    counters_.thread_error.add(waited);
    counters_.thread_late += waited > kLate;
    if (late > latest.late)
      latest = { .lead = command.lead, .late = late };
  }
  if (latest.late > kLate)
    note(latest);
}

void
TactorActuation::note(const ShortLead &lead)
{
  if (!short_lead_ || lead.late > short_lead_->late)
    short_lead_ = lead;
}

/// Adds the volts to be written, unless the board has them.
TactorActuation::Step
TactorActuation::with_volts(const Now &now, Step step)
{
  if (!open_)
    return step;

  const std::span<const double> levels = queue_.levels();
  // All tactors that the board has levels of, or gets now.
  const auto last
      = std::find_if(levels.rbegin(), levels.rend(), [](double volts) { return volts != 0; });
  std::size_t used = std::max(sent_.size(), static_cast<std::size_t>(levels.rend() - last));
  for (const Command &command : step.commands)
    used = std::max(used, static_cast<std::size_t>(command.tactor) + 1);
  used = std::min(used, levels.size());

  sent_.resize(used, 0.0);
  std::vector<double> volts(used, 0.0);
  if (now.silent)
    soft_start_.arm();
  else if (now.timed && last != levels.rend())
    counters_.ramps += soft_start_.vibrate(step.running, line_.of(vibrating(levels)));
  ceiling_ = soft_start_.ceiling(step.running);
  const double ceiling = full_scale_volts_ * (now.timed ? ceiling_ : 1.0);
  if (!now.silent)
    std::transform(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(used),
                   volts.begin(), [=](double level) { return std::min(level, ceiling); });
  if (volts != sent_ || (refresh_ && *refresh_ <= step.running))
    step.volts = std::move(volts);
  return step;
}

/// A change that no command led to (pause, resume, mute, flush, a lost board) is traced as due and
/// in effect when it happened.
void
TactorActuation::trace(Time running, std::span<const Command> commands,
                       std::span<const double> volts)
{
  if (!trace_)
    return;
  for (std::size_t i = 0; i < volts.size(); i++) {
    if (volts[i] == sent_[i])
      continue;
    const int index = static_cast<int>(i);
    const auto command = std::ranges::find(commands, index, &Command::tactor);
    Command sent{ .effect = running, .lead = Time(0), .tactor = index, .volts = volts[i] };
    if (command != commands.end())
      sent = *command;
    sent.volts = volts[i];
    trace_->write({ .command = sent, .issued = running });
  }
}
