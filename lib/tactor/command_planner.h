// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/command.h"
#include "tactor/felt_blocks.h"
#include "tactor/motor_limits.h"
#include "tactor/motor_model.h"
#include "tactor/planner_settings.h"
#include "tactor/rise_time.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactor {

/// Turns the stream of tactile maps into commands. All times are running times; maps come in order
/// of time. Not thread-safe: tactorsink's streaming thread has it.
///
/// Maps are taken in FeltBlocks. With Compensation::frame_block, blocks are those of the grid
/// alone, as in the paper. The grid begins anew after silence(), reset() and a change of rate,
/// mapping or number of cells.
///
/// A command is due so early that it is at its motor at arrival_time(). Commands for one tactor are
/// never due before their predecessors, on whose amplitude they build.
///
/// MotorLimits hold for the times at which commands are due, whatever comes after:
/// - Each command has the time at which its cue ends at the latest. A tactor whose cue was ended by
///   a limit stays off until a block without a level for it, kLongestRest at most. No cue begins
///   that would last less than kShortestCue.
/// - At most max_active tactors are on, the strongest ones; of equals those that are on already.
///   Where a rise begins before the frame at which another tactor ends, that one ends early, the
///   weakest first.
/// - reset() restarts running time, but not the account of on-times. How long nothing was played is
///   unknown, so that it counts as no time.
class CommandPlanner
{
public:
  /// The rest after 2 s on at a duty of 40 %.
  static constexpr Time kLongestRest = std::chrono::seconds(3);
  /// A motor takes up to 180 ms to rise: a shorter cue would not reach its level.
  static constexpr Time kShortestCue = std::chrono::milliseconds(200);

  explicit CommandPlanner(int tactors, PlannerSettings settings = {}, RiseTime rise_time = {});
  /// Tactor i has motors[i]; those beyond motors.size() have the paper's motor.
  CommandPlanner(int tactors, PlannerSettings settings, std::vector<MotorParameters> motors);

  /// New settings apply from the next map on.
  void set_settings(PlannerSettings settings);
  const PlannerSettings &settings() const;

  /// Why a mapping does not fit a film of `cells` and a board of `tactors`, in one line; empty if
  /// it does.
  static std::string validate_mapping(std::span<const int> mapping, int cells, int tactors);

  /// Plans the map of the frame shown during [time, time + duration); duration ≤ 0 is 1/30 s.
  /// `levels` are row-major in [0, 1]; others are clamped, NaN is 0. Returns the commands of the
  /// block that begins here; none inside a block or where nothing changes. If cells share a tactor,
  /// the strongest counts; cells without a tactor are ignored. A map that is taken `at_once`
  /// is a block of its own, and leaves those of the rate as they are.
  std::vector<Command> plan(Time time, Time duration, std::span<const float> levels,
                            bool at_once = false);

  /// All tactors to zero at `time` (gap, end of stream). The next map begins a block.
  std::vector<Command> silence(Time time);

  /// The motors were silenced at `time` for want of a map, and commands due later were dropped. The
  /// next map begins a block.
  void silenced(Time time);

  /// As silenced(), and running time restarts (flush).
  void reset(Time time);

  /// Before the first map: what the tactors did in earlier plays, by a clock of its own that says
  /// `now`. Until the first command may be due no time passes.
  void resume(const std::vector<MotorUse> &uses, Time now);

  /// Since construction.
  const LimitCounters &limited() const;

private:
  /// A tactor after the commands planned so far.
  struct Tactor
  {
    MotorModel motor;
    double volts = 0;
    std::size_t index = 0;
    Time due = Time::min();
    Time arrival = Time::min(); ///< of the last command at the motor
    Time until = Time::max();   ///< Command::until of the last command
    MotorUse use{};
    MotorUse::End end{};               ///< latest end of the present cue
    std::optional<Time> spent_since{}; ///< a limit ended its cue, and it still has a level
    bool outdone = false;              ///< it has a level, but stronger ones are on
  };

  /// The plan of one call.
  struct Plan
  {
    Time effect;    ///< running time of the frame
    Time frame;     ///< its duration
    Time line{ 0 }; ///< how long the line takes for the levels that change
    std::vector<Command> commands{};
  };

  Plan begin_plan(Time effect, Time frame);
  std::vector<double> target_volts() const;

  void limit_time(const Plan &plan, std::vector<double> &volts);
  void limit_number(std::vector<double> &volts);
  Time make_room(Plan &plan, std::size_t index, Time due, std::span<const double> volts);
  void spend(Tactor &tactor, Time since, MotorUse::Limit limit);

  void turn_on(Plan &plan, std::size_t index, std::span<const double> volts);
  void turn_off(Plan &plan, std::size_t index, Time due, bool limited = false);
  void give(Plan &plan, std::size_t index, Time effect, Time due, double volts);

  double wanted_volts(const Tactor &tactor, double level) const;
  Time line_time(std::span<const double> volts) const;
  Time transport(const Tactor &tactor, Time line) const;
  Time latest(const Tactor &tactor, const Plan &plan) const;
  Time due_time(const Tactor &tactor, const Plan &plan, double volts, Time kick) const;

  PlannerSettings settings_;
  std::vector<Tactor> tactors_;
  LimitCounters limited_;
  std::optional<Time> restarts_after_; ///< running time restarts; the last one before
  Time account_begin_ = Time::min();   ///< first running time since the last reset()
  FeltBlocks blocks_;
};

} // namespace tactor
