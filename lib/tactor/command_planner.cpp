// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_planner.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

namespace tactor {

namespace {

constexpr Time kDefaultFrame = Time(1'000'000'000 / 30);

/// How finely the time to issue a command is searched for, and how exactly it is then found.
constexpr Time kSearchStep = std::chrono::milliseconds(1);
constexpr Time kSearchGoal = std::chrono::microseconds(1);

/// A number of frames that exceeds a whole one by less is that one.
constexpr double kSameFrames = 1e-6;

/// An amplitude that differs by less is the same.
constexpr double kSameVolts = 1e-6;

/// A motor with less than this left of its vibration is at rest.
constexpr double kStillVolts = 0.1 * kStartVolts;

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// The paper's data block: the rise time in whole frames, rounded up, but no more than fit into
/// max_lead.
Time
whole_frames(Time rise, Time frame, Time max_lead)
{
  // A rise of a whole number of frames takes that many, whichever way the frame's duration was
  // rounded.
  const double whole = std::ceil(seconds(rise) / seconds(frame) - kSameFrames);
  return std::min(static_cast<Time::rep>(whole), max_lead / frame) * frame;
}

} // namespace

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
    forget_blocks();
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
CommandPlanner::plan(Time time, Time duration, std::span<const float> levels)
{
  const Time frame = duration > Time(0) ? duration : kDefaultFrame;
  if (levels.size() != cells_) {
    cells_ = levels.size();
    forget_blocks();
  }
  if (!begins_block(time, frame))
    return {};
  Plan plan = begin_plan(time, frame);
  std::vector<double> volts = target_volts(levels);
  plan.line = line_time(volts);
  limit_time(plan, volts);
  limit_number(volts);
  // Tactors that begin may have others end; what is left of these ends with the frame before.
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
  carried_ = { time, time };
  for (const Command &command : plan.commands)
    carried_->end += settings_.line.of(static_cast<std::size_t>(command.tactor));
  std::ranges::stable_sort(plan.commands, {}, &Command::tactor);
  return std::move(plan.commands);
}

std::vector<Command>
CommandPlanner::silence(Time time)
{
  forget_blocks();
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
  forget_blocks();
  for (Tactor &tactor : tactors_) {
    if (tactor.use.is_on() && tactor.end.time < time) {
      spend(tactor, tactor.end.time, tactor.end.limit);
      tactor.use.end(tactor.end.time, true);
    }
    tactor.use.forget_from(time);
    tactor = { .motor = MotorModel(tactor.motor.parameters()),
               .index = tactor.index,
               .due = time,
               .use = std::move(tactor.use) };
  }
}

void
CommandPlanner::reset(Time time)
{
  // Twice with nothing in between: the time of the second is that of a film of which nothing was
  // played.
  if (!restarts_after_)
    restarts_after_ = std::max(time, account_begin_);
  silenced(*restarts_after_);
  for (Tactor &tactor : tactors_)
    tactor.due = Time::min();
}

const LimitCounters &
CommandPlanner::limited() const
{
  return limited_;
}

void
CommandPlanner::forget_blocks()
{
  grid_start_.reset();
  carried_.reset();
}

bool
CommandPlanner::begins_block(Time time, Time duration)
{
  if (carried_ && time >= carried_->begin && time < carried_->end)
    return false;
  if (settings_.rate <= 0)
    return true;
  if (!grid_start_ || time < *grid_start_) {
    grid_start_ = time;
    next_block_ = 1;
    return true;
  }
  // In the middle of its frame, so that neither rounded timestamps nor a frame rate that does not
  // divide shift the grid.
  const double blocks = seconds(time - *grid_start_ + duration / 2) * settings_.rate;
  if (blocks < next_block_)
    return false;
  if (blocks >= next_block_ + 1) {
    // Whole blocks went by without a map: what is left of this one may be too short to be felt.
    grid_start_ = time;
    next_block_ = 1;
  } else {
    next_block_++;
  }
  return true;
}

std::vector<double>
CommandPlanner::target_volts(std::span<const float> levels) const
{
  std::vector<double> volts(tactors_.size(), 0.0);
  for (std::size_t cell = 0; cell < levels.size(); cell++) {
    const std::vector<int> &mapping = settings_.mapping;
    const int tactor = mapping.empty()         ? static_cast<int>(cell)
                       : cell < mapping.size() ? mapping[cell]
                                               : -1;
    if (tactor < 0 || static_cast<std::size_t>(tactor) >= volts.size())
      continue;
    const double level
        = levels[cell] > 0 ? std::min(static_cast<double>(levels[cell]), 1.0) : 0.0; // NaN is 0
    const auto index = static_cast<std::size_t>(tactor);
    volts[index] = std::max(volts[index], wanted_volts(tactors_[index], level));
  }
  // Half a microvolt: 1/6 as a float, of 3 V, shall not fall short of 0.5 V, below which motors
  // stand still.
  for (std::size_t i = 0; i < volts.size(); i++) {
    const MotorParameters &motor = tactors_[i].motor.parameters();
    const bool held = tactors_[i].use.is_on() || settings_.kick_start;
    const double least = !motor.thresholds_measured ? settings_.volts_min
                         : held                     ? motor.hold_volts
                                                    : motor.start_volts;
    volts[i] = volts[i] < least - kSameVolts / 2 ? 0 : std::max(volts[i], least);
  }
  return volts;
}

/// What the level asks for, whether the motor turns with it or not.
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

/// Begins the plan of a frame: time is reckoned on from before a reset(), cues that have run out by
/// then are over.
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

/// Takes the volts from tactors whose cue is over or that have to rest, and says when the others
/// have to end.
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
      // The same as before unless the limits were changed.
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
    const Time begin
        = std::max(due_time(tactor, plan, volts[i], kick_time(tactor, plan.effect, volts[i])),
                   tactor.use.ready_at());
    const MotorUse::End end = tactor.use.latest_end(begin, limits);
    const Time shortest = std::min(Time(kShortestCue), MotorUse().latest_end(Time(0), limits).time);
    if (end.time < begin + shortest) {
      spend(tactor, plan.effect, end.limit);
      volts[i] = 0;
    }
  }
}

/// Takes the volts from all but the strongest.
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

/// The earliest time from `due` on at which the tactor may join those that are on. Tactors that end
/// with this frame end as early as it takes, the weakest first.
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
    // As many may still be on.
    const auto last = off.begin() + static_cast<std::ptrdiff_t>(others);
    std::ranges::nth_element(off, last, std::greater{});
    if (*last <= due || !weakest)
      return std::max(due, *last);
    turn_off(plan, *weakest, due);
  }
}

/// A cue has run out, or may not begin.
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
  const Time kick = kick_time(tactor, plan.effect, volts[index]);
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
  // A cue that ran out did so at its own time, not with the frame.
  give(plan, index, limited ? due + transport(tactor, plan.line) : plan.effect, due, 0);
}

/// A command, entered into what is known of the tactor.
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

/// How long the line is taken by what changes if the tactors get these volts, but for those that
/// MotorLimits::max_active leaves as they are: as many may begin as may end.
Time
CommandPlanner::line_time(std::span<const double> volts) const
{
  std::vector<std::size_t> changed;
  for (const Tactor &tactor : tactors_)
    if (volts[tactor.index] != tactor.volts)
      changed.push_back(tactor.index);
  return settings_.line.of(changed, settings_.limits.most_changes());
}

/// How long a command is on its way to its motor among those that take the line for so long.
Time
CommandPlanner::transport(const Tactor &tactor, Time line) const
{
  if (settings_.compensation != Compensation::exact)
    return Time(0);
  const Time own = settings_.line.of(tactor.index);
  line = std::max(line, own);
  // A motor's latency was measured with it alone on the line.
  if (const std::optional<Time> latency = tactor.motor.parameters().latency)
    return *latency + line - own;
  return std::max(settings_.transport_latency - settings_.line.all(), Time(0)) + line;
}

/// When a command for the frame is due at the latest.
Time
CommandPlanner::latest(const Tactor &tactor, const Plan &plan) const
{
  return plan.effect - transport(tactor, plan.line);
}

/// How long a rise to `volts` begins with full voltage; 0: not at all.
Time
CommandPlanner::kick_time(const Tactor &tactor, Time effect, double volts) const
{
  if (!settings_.kick_start)
    return Time(0);
  const Time kick = overdrive_time(tactor.motor.parameters().rise_time, settings_.volts_max, volts);
  if (kick == Time(0))
    return kick;
  const Time time = std::max(kick, Time(kShortestKick));
  return tactor.motor.amplitude(effect - time) < kStillVolts ? time : Time(0);
}

/// When a command for the frame is due that brings a tactor to `volts`; `kick` as of kick_time().
/// Never before its predecessor.
Time
CommandPlanner::due_time(const Tactor &tactor, const Plan &plan, double volts, Time kick) const
{
  const Time effect = plan.effect;
  const Time on_the_way = transport(tactor, plan.line);
  const Time previous
      = tactor.due == Time::min() ? Time::min() : std::max(tactor.due + on_the_way, tactor.arrival);
  // When the command reaches the motor: not before its predecessor did, nor earlier than it may.
  const Time earliest = std::min(std::max(previous, effect - settings_.max_lead), effect);
  Time at = effect;
  if (settings_.compensation == Compensation::exact) {
    at = kick > Time(0) ? std::max(effect - kick, earliest)
                        : exact_time(tactor, earliest, effect, volts);
  } else if (settings_.compensation == Compensation::frame_block) {
    const Time rise
        = kick > Time(0)
              ? kick
              : tactor.motor.parameters().rise_time(tactor.motor.amplitude(earliest), volts);
    at = std::max(effect - whole_frames(rise, plan.frame, settings_.max_lead), earliest);
  }
  return std::max(at - on_the_way, tactor.due);
}

/// The latest time in [earliest, effect] from which the motor rises to 90 % of `volts` by `effect`;
/// `earliest` if there is none.
Time
CommandPlanner::exact_time(const Tactor &tactor, Time earliest, Time effect, double volts) const
{
  const RiseTime &rise_time = tactor.motor.parameters().rise_time;
  const auto arrives = [&](Time time) {
    return time + rise_time(tactor.motor.amplitude(time), volts) <= effect;
  };
  const double now = tactor.motor.amplitude(earliest);
  if (std::abs(tactor.motor.amplitude(effect) - now) < kSameVolts)
    return std::max(effect - rise_time(now, volts), earliest);

  // The motor is still on its way: the rise time depends on when the command comes, and not
  // monotonically (Eq. 1 is not).
  if (arrives(effect))
    return effect;
  Time late = effect;
  Time early = effect;
  while (!arrives(early)) {
    if (early == earliest)
      return earliest;
    late = early;
    early = std::max(early - kSearchStep, earliest);
  }
  while (late - early > kSearchGoal) {
    const Time middle = early + (late - early) / 2;
    (arrives(middle) ? early : late) = middle;
  }
  return early;
}

} // namespace tactor
