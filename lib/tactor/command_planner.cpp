// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_planner.h"

#include <algorithm>
#include <cmath>
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

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

} // namespace

CommandPlanner::CommandPlanner(int tactors, PlannerSettings settings, RiseTime rise_time)
    : settings_(std::move(settings)), rise_time_(std::move(rise_time)),
      tactors_(static_cast<std::size_t>(std::max(tactors, 0)),
               Tactor{ .motor = MotorModel(rise_time_) })
{
}

void
CommandPlanner::set_settings(PlannerSettings settings)
{
  if (settings.rate != settings_.rate || settings.mapping != settings_.mapping)
    grid_start_.reset();
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
    grid_start_.reset();
  }
  std::vector<Command> commands;
  if (!begins_block(time, frame))
    return commands;
  const std::vector<double> volts = target_volts(levels);
  for (std::size_t i = 0; i < tactors_.size(); i++)
    if (volts[i] != tactors_[i].volts)
      commands.push_back(command(static_cast<int>(i), time, frame, volts[i]));
  return commands;
}

std::vector<Command>
CommandPlanner::silence(Time time)
{
  grid_start_.reset();
  std::vector<Command> commands;
  for (std::size_t i = 0; i < tactors_.size(); i++)
    if (tactors_[i].volts != 0)
      commands.push_back(command(static_cast<int>(i), time, kDefaultFrame, 0));
  return commands;
}

void
CommandPlanner::reset()
{
  grid_start_.reset();
  std::ranges::fill(tactors_, Tactor{ .motor = MotorModel(rise_time_) });
}

bool
CommandPlanner::begins_block(Time time, Time duration)
{
  if (settings_.rate <= 0)
    return true;
  if (!grid_start_ || time < *grid_start_) {
    grid_start_ = time;
    next_block_ = 1;
    return true;
  }
  // In the middle of its frame, so that neither rounded timestamps nor a frame rate that does not divide shift the grid.
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
    double &target = volts[static_cast<std::size_t>(tactor)];
    target = std::max(target, level * settings_.intensity * settings_.volts_max);
  }
  // Half a microvolt: 1/6 as a float, of 3 V, shall not fall short of 0.5 V, below which motors stand still.
  for (double &target : volts)
    target
        = target < settings_.volts_min - kSameVolts / 2 ? 0 : std::max(target, settings_.volts_min);
  return volts;
}

/// The command that brings a tactor to `volts` for the frame at `effect`, entered into what is known of the tactor.
Command
CommandPlanner::command(int index, Time effect, Time frame, double volts)
{
  Tactor &tactor = tactors_[static_cast<std::size_t>(index)];
  const Time transport
      = settings_.compensation == Compensation::exact ? settings_.transport_latency : Time(0);
  const Time previous = tactor.due == Time::min() ? Time::min() : tactor.due + transport;
  // When the command reaches the motor: not before its predecessor did, nor earlier than it may.
  const Time earliest = std::min(std::max(previous, effect - settings_.max_lead), effect);
  Time at = effect;
  if (settings_.compensation == Compensation::exact)
    at = exact_time(tactor, earliest, effect, volts);
  else if (settings_.compensation == Compensation::frame_block)
    at = frame_block_time(tactor, earliest, effect, frame, volts);

  // Never before its predecessor, nor after its effect, even if maps or the transport latency go back.
  tactor.due = std::max(at - transport, tactor.due);
  effect = std::max(effect, tactor.due);
  tactor.volts = volts;
  tactor.motor.set(at, volts);
  return { .effect = effect, .lead = effect - tactor.due, .tactor = index, .volts = volts };
}

/// The latest time in [earliest, effect] from which the motor rises to 90 % of `volts` by `effect`; `earliest` if there is none.
Time
CommandPlanner::exact_time(const Tactor &tactor, Time earliest, Time effect, double volts) const
{
  const auto arrives = [&](Time time) {
    return time + rise_time_(tactor.motor.amplitude(time), volts) <= effect;
  };
  const double now = tactor.motor.amplitude(earliest);
  if (std::abs(tactor.motor.amplitude(effect) - now) < kSameVolts)
    return std::max(effect - rise_time_(now, volts), earliest);

  // The motor is still on its way: the rise time depends on when the command comes, and not monotonically (Eq. 1 is not).
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

/// The paper's data block: the rise time in whole frames, rounded up, before the frame. The lead stays a number of whole frames within max_lead.
Time
CommandPlanner::frame_block_time(const Tactor &tactor, Time earliest, Time effect, Time frame,
                                 double volts) const
{
  const Time rise = rise_time_(tactor.motor.amplitude(earliest), volts);
  // A rise of a whole number of frames takes that many, whichever way the frame's duration was rounded.
  const double whole = std::ceil(seconds(rise) / seconds(frame) - kSameFrames);
  const Time::rep frames = std::min(static_cast<Time::rep>(whole), settings_.max_lead / frame);
  return std::max(effect - frames * frame, earliest);
}

} // namespace tactor
