// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_planner.h"

#include "tactor/arrival.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

namespace tactor {

static constexpr Time kDefaultFrame = Time(1'000'000'000 / 30);

/// Later than any running time.
static constexpr Time kAfterAll = std::chrono::hours(24 * 366 * 40);

/// 1/6 as a float, of 3 V, must not fall below 0.5 V, where motors do not start.
static constexpr double kRounding = 0.5e-6;

CommandPlanner::CommandPlanner(int tactors, PlannerSettings settings, RiseTime rise_time)
    : settings_(std::move(settings)), tactors_(static_cast<std::size_t>(std::max(tactors, 0)),
                                               Tactor{ .motor = MotorModel(std::move(rise_time)) })
{
  for (std::size_t i = 0; i < tactors_.size(); i++)
    tactors_[i].index = i;
}

CommandPlanner::CommandPlanner(int tactors, PlannerSettings settings,
                               std::vector<MotorParameters> motors)
    : CommandPlanner(tactors, std::move(settings))
{
  for (std::size_t i = 0; i < std::min(tactors_.size(), motors.size()); i++)
    tactors_[i].motor = MotorModel(std::move(motors[i]));
}

void
CommandPlanner::set_settings(PlannerSettings settings)
{
  if (settings.rate != settings_.rate || settings.mapping != settings_.mapping)
    blocks_.restart();
  settings_ = std::move(settings);
}

const PlannerSettings &
CommandPlanner::settings() const
{
  return settings_;
}

std::string
CommandPlanner::validate_mapping(std::span<const int> mapping, int cells, int tactors)
{
  if (mapping.empty()) {
    if (cells > tactors)
      return "the film has " + std::to_string(cells) + " cells, the board "
             + std::to_string(tactors) + " tactors";
    return {};
  }
  if (std::ssize(mapping) != cells)
    return "expected a mapping of " + std::to_string(cells) + " cells, got one of "
           + std::to_string(mapping.size());
  for (const int tactor : mapping)
    if (tactor >= tactors)
      return "the mapping names tactor " + std::to_string(tactor) + ", the board has "
             + std::to_string(tactors);
  return {};
}

std::vector<Command>
CommandPlanner::plan(Time time, Time duration, std::span<const float> levels, bool at_once)
{
  const Time frame = duration > Time(0) ? duration : kDefaultFrame;
  if (!blocks_.take({ time, frame, levels, at_once }, settings_.rate,
                    settings_.compensation == Compensation::frame_block))
    return {};
  Plan plan = begin_plan(time, frame);
  std::vector<double> volts = target_volts();
  plan.line = line_time(volts);
  limit_time(plan, volts);
  limit_number(volts);
  // A tactor that begins may end others early. The other ends are those of the frame before.
  for (std::size_t i = 0; i < tactors_.size(); i++)
    if (volts[i] != 0 && !tactors_[i].use.is_on())
      turn_on(plan, i, volts);
  for (std::size_t i = 0; i < tactors_.size(); i++) {
    const Tactor &tactor = tactors_[i];
    if (!tactor.use.is_on())
      continue;
    if (volts[i] == 0)
      turn_off(plan, i, latest(tactor, plan));
    else if (volts[i] != tactor.volts || tactor.end.time != tactor.until)
      give(plan, i, plan.effect, due_time(tactor, plan, volts[i], Time(0)), volts[i]);
  }
  Time carried{ 0 };
  for (const Command &command : plan.commands)
    carried += settings_.line.of(static_cast<std::size_t>(command.tactor));
  blocks_.carry(time, carried);
  std::ranges::stable_sort(plan.commands, {}, &Command::tactor);
  return std::move(plan.commands);
}

std::vector<Command>
CommandPlanner::silence(Time time)
{
  blocks_.silence();
  Plan plan = begin_plan(time, kDefaultFrame);
  plan.line = line_time(std::vector<double>(tactors_.size(), 0.0));
  for (std::size_t i = 0; i < tactors_.size(); i++) {
    if (tactors_[i].use.is_on())
      turn_off(plan, i, latest(tactors_[i], plan));
    tactors_[i].spent_since.reset();
    tactors_[i].outdone = false;
  }
  std::ranges::stable_sort(plan.commands, {}, &Command::tactor);
  return std::move(plan.commands);
}

void
CommandPlanner::silenced(Time time)
{
  blocks_.silence();
  for (Tactor &tactor : tactors_) {
    if (tactor.use.is_on() && tactor.end.time < time) {
      spend(tactor, tactor.end.time, tactor.end.limit);
      tactor.use.end(tactor.end.time, true);
    }
    tactor.use.forget_from(restarts_after_.value_or(time)); // its entries are on that time line
    tactor = { .motor = MotorModel(tactor.motor.parameters()),
               .index = tactor.index,
               .due = time,
               .use = std::move(tactor.use) };
  }
}

void
CommandPlanner::reset(Time time)
{
  // A second reset before any plan: its time is on a time line of which nothing was played.
  if (!restarts_after_)
    restarts_after_ = std::max(time, account_begin_);
  silenced(*restarts_after_);
  for (Tactor &tactor : tactors_)
    tactor.due = Time::min();
}

void
CommandPlanner::resume(const std::vector<MotorUse> &uses, Time now)
{
  restarts_after_ = kAfterAll;
  for (std::size_t i = 0; i < std::min(tactors_.size(), uses.size()); i++) {
    tactors_[i].use = uses[i].with_rest(MotorUse::kShortestRest);
    tactors_[i].use.age(now - kAfterAll);
  }
}

const LimitCounters &
CommandPlanner::limited() const
{
  return limited_;
}

std::vector<double>
CommandPlanner::target_volts() const
{
  std::vector<double> volts(tactors_.size(), 0.0);
  for (std::size_t cell = 0; cell < blocks_.cells(); cell++) {
    const std::vector<int> &mapping = settings_.mapping;
    const int tactor = mapping.empty()         ? static_cast<int>(cell)
                       : cell < mapping.size() ? mapping[cell]
                                               : -1;
    if (tactor < 0 || static_cast<std::size_t>(tactor) >= volts.size())
      continue;
    const auto index = static_cast<std::size_t>(tactor);
    volts[index] = std::max(
        volts[index], wanted_volts(tactors_[index], static_cast<double>(blocks_.level(cell))));
  }
  for (std::size_t i = 0; i < volts.size(); i++) {
    const MotorParameters &motor = tactors_[i].motor.parameters();
    const bool held = tactors_[i].use.is_on() || settings_.kick_start;
    const double least = !motor.thresholds_measured ? settings_.volts_min
                         : held                     ? motor.hold_volts
                                                    : motor.start_volts;
    volts[i] = volts[i] < least - kRounding ? 0 : std::max(volts[i], least);
  }
  return volts;
}

/// The voltage of a level, whether it starts the motor or not.
double
CommandPlanner::wanted_volts(const Tactor &tactor, double level) const
{
  const std::vector<double> &curve = tactor.motor.parameters().level_volts;
  const double wanted = level * settings_.intensity;
  if (curve.size() < 2)
    return wanted * settings_.volts_max;
  const double place = wanted * static_cast<double>(curve.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), curve.size() - 2);
  const double volts
      = std::lerp(curve[below], curve[below + 1], place - static_cast<double>(below));
  return std::min(volts, settings_.volts_max);
}

/// Begins the plan of a frame. Ages the account after a reset() and ends the cues that are over by
/// then.
CommandPlanner::Plan
CommandPlanner::begin_plan(Time effect, Time frame)
{
  if (restarts_after_) {
    Time slowest = settings_.transport_latency;
    for (const Tactor &tactor : tactors_)
      slowest = std::max(slowest, transport(tactor, settings_.line.all()));
    const Time first = effect - settings_.max_lead - slowest;
    if (*restarts_after_ > first)
      for (Tactor &tactor : tactors_)
        tactor.use.age(*restarts_after_ - first);
    restarts_after_.reset();
    account_begin_ = first;
  }
  Plan plan{ .effect = effect, .frame = frame };
  for (std::size_t i = 0; i < tactors_.size(); i++) {
    Tactor &tactor = tactors_[i];
    if (!tactor.use.is_on() || tactor.end.time > latest(tactor, plan))
      continue;
    spend(tactor, tactor.end.time, tactor.end.limit);
    turn_off(plan, i, tactor.end.time, true);
  }
  return plan;
}

/// Zeroes the volts of tactors whose cue is over or that have to rest, and sets the latest end of
/// the others.
void
CommandPlanner::limit_time(const Plan &plan, std::vector<double> &volts)
{
  const MotorLimits &limits = settings_.limits;
  for (std::size_t i = 0; i < tactors_.size(); i++) {
    Tactor &tactor = tactors_[i];
    if (volts[i] == 0) {
      tactor.spent_since.reset();
      continue;
    }
    if (tactor.use.is_on()) {
      // Anew, since the limits may have changed.
      tactor.end = tactor.use.latest_end(tactor.use.on_since(), limits);
      if (tactor.end.time <= latest(tactor, plan)) {
        spend(tactor, plan.effect, tactor.end.limit);
        volts[i] = 0;
      }
      continue;
    }
    const bool rests = tactor.spent_since && plan.effect - *tactor.spent_since < Time(kLongestRest);
    if (rests || tactor.use.ready_at() > latest(tactor, plan)) {
      volts[i] = 0;
      continue;
    }
    tactor.spent_since.reset();
    const Time begin = std::max(
        due_time(tactor, plan, volts[i],
                 kick_time(tactor.motor, { plan.effect, plan.frame, volts[i] }, settings_)),
        tactor.use.ready_at());
    const MotorUse::End end = tactor.use.latest_end(begin, limits);
    const Time shortest = std::min(Time(kShortestCue), MotorUse().latest_end(Time(0), limits).time);
    if (end.time < begin + shortest) {
      spend(tactor, plan.effect, end.limit);
      volts[i] = 0;
    }
  }
}

/// Zeroes the volts of all but the strongest max_active.
void
CommandPlanner::limit_number(std::vector<double> &volts)
{
  if (settings_.limits.max_active <= 0)
    return;
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < tactors_.size(); i++) {
    if (volts[i] != 0)
      wanted.push_back(i);
    else
      tactors_[i].outdone = false;
  }
  std::ranges::sort(wanted, [&](std::size_t a, std::size_t b) {
    const auto rank = [&](std::size_t i) {
      return std::tuple(-volts[i], !tactors_[i].use.is_on(), i);
    };
    return rank(a) < rank(b);
  });
  for (std::size_t rank = 0; rank < wanted.size(); rank++) {
    Tactor &tactor = tactors_[wanted[rank]];
    const bool outdone = rank >= static_cast<std::size_t>(settings_.limits.max_active);
    if (outdone)
      volts[wanted[rank]] = 0;
    if (outdone && !tactor.outdone)
      limited_.number++;
    tactor.outdone = outdone;
  }
}

/// The earliest time from `due` on at which the tactor may be on without exceeding max_active.
/// Tactors that end with this frame end earlier for it, the weakest first.
Time
CommandPlanner::make_room(Plan &plan, std::size_t index, Time due, std::span<const double> volts)
{
  const std::size_t others = static_cast<std::size_t>(settings_.limits.max_active) - 1;
  if (settings_.limits.max_active <= 0 || others + 1 >= tactors_.size())
    return due;
  for (;;) {
    std::vector<Time> off;
    std::optional<std::size_t> weakest;
    for (std::size_t i = 0; i < tactors_.size(); i++) {
      if (i == index)
        continue;
      const Tactor &tactor = tactors_[i];
      const bool ends = tactor.use.is_on() && volts[i] == 0;
      if (ends && (!weakest || tactor.volts < tactors_[*weakest].volts))
        weakest = i;
      off.push_back(ends ? std::max(latest(tactor, plan), tactor.due) : tactor.use.off_since());
    }
    const auto last = off.begin() + static_cast<std::ptrdiff_t>(others);
    std::ranges::nth_element(off, last, std::greater{});
    if (*last <= due || !weakest)
      return std::max(due, *last);
    turn_off(plan, *weakest, due);
  }
}

/// A limit ends a cue or keeps it from beginning.
void
CommandPlanner::spend(Tactor &tactor, Time since, MotorUse::Limit limit)
{
  tactor.spent_since = since;
  (limit == MotorUse::Limit::duty ? limited_.duty : limited_.on_time)++;
}

void
CommandPlanner::turn_on(Plan &plan, std::size_t index, std::span<const double> volts)
{
  Tactor &tactor = tactors_[index];
  const Time kick = kick_time(tactor.motor, { plan.effect, plan.frame, volts[index] }, settings_);
  Time due = std::max(due_time(tactor, plan, volts[index], kick), tactor.use.ready_at());
  due = make_room(plan, index, due, volts);
  const MotorUse::End end = tactor.use.latest_end(due, settings_.limits);
  if (end.time <= due)
    return;
  tactor.end = end;
  tactor.use.begin(due);
  if (kick > Time(0) && due + kick < end.time) {
    give(plan, index, plan.effect, due, settings_.volts_max);
    due += kick;
  }
  give(plan, index, plan.effect, due, volts[index]);
}

void
CommandPlanner::turn_off(Plan &plan, std::size_t index, Time due, bool limited)
{
  Tactor &tactor = tactors_[index];
  due = std::max(due, tactor.due);
  tactor.end = {};
  tactor.use.end(due, limited);
  // A cue that a limit ends does so at its own time, not with the frame.
  give(plan, index, limited ? due + transport(tactor, plan.line) : plan.effect, due, 0);
}

/// Adds a command to the plan and to the tactor's state.
void
CommandPlanner::give(Plan &plan, std::size_t index, Time effect, Time due, double volts)
{
  Tactor &tactor = tactors_[index];
  tactor.due = due;
  tactor.volts = volts;
  tactor.until = tactor.end.time;
  tactor.arrival = due + transport(tactor, plan.line);
  tactor.motor.set(tactor.arrival, volts);
  effect = std::max(effect, due);
  plan.commands.push_back({ .effect = effect,
                            .lead = effect - due,
                            .tactor = static_cast<int>(index),
                            .volts = volts,
                            .until = tactor.until });
}

/// How long the line takes for the change to these volts; max_active bounds how many tactors can
/// change.
Time
CommandPlanner::line_time(std::span<const double> volts) const
{
  std::vector<std::size_t> changed;
  for (const Tactor &tactor : tactors_)
    if (volts[tactor.index] != tactor.volts)
      changed.push_back(tactor.index);
  return settings_.line.of(changed, settings_.limits.most_changes());
}

/// How long a command takes to its motor, if all commands of its block take the line for `line`.
Time
CommandPlanner::transport(const Tactor &tactor, Time line) const
{
  if (settings_.compensation != Compensation::exact)
    return Time(0);
  const Time own = settings_.line.of(tactor.index);
  line = std::max(line, own);
  // The measured latency has this motor's own time on the line in it.
  if (const std::optional<Time> latency = tactor.motor.parameters().latency)
    return *latency + line - own;
  return std::max(settings_.transport_latency - settings_.line.all(), Time(0)) + line;
}

/// The latest due time of a command for the frame.
Time
CommandPlanner::latest(const Tactor &tactor, const Plan &plan) const
{
  return plan.effect - transport(tactor, plan.line);
}

/// When a command that brings a tactor to `volts` for the frame is due, never before its
/// predecessor. `kick` is that of kick_time().
Time
CommandPlanner::due_time(const Tactor &tactor, const Plan &plan, double volts, Time kick) const
{
  const Time on_the_way = transport(tactor, plan.line);
  const Time previous
      = tactor.due == Time::min() ? Time::min() : std::max(tactor.due + on_the_way, tactor.arrival);
  const Time arrival
      = arrival_time(tactor.motor, { plan.effect, plan.frame, volts }, previous, kick, settings_);
  return std::max(arrival - on_the_way, tactor.due);
}

} // namespace tactor
