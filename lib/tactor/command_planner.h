// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/line_time.h"
#include "tactor/motor_limits.h"
#include "tactor/motor_model.h"
#include "tactor/rise_time.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactor {

/// How a command is moved before the frame it belongs to (paper, Section 4).
enum class Compensation
{
  exact, ///< issued at T − rise time, not rounded
  /// The paper's: T − rise time rounded up to whole frames, "first three frames old, remaining two
  /// new".
  frame_block,
  none, ///< issued at T
};

/// One tactor gets one voltage.
struct Command
{
  Time effect{ 0 }; ///< running time of the frame: when the vibration shall be there
  Time lead{ 0 };   ///< how much earlier the command is issued, ≥ 0
  int tactor = 0;
  double volts = 0;
  Time until = Time::max(); ///< the motor is off from then on if no other command for it comes
  Time known = Time::min(); ///< when it was handed over to be issued; not the planner's

  Time due() const
  {
    return effect - lead;
  }
  bool operator==(const Command &) const = default;
};

struct PlannerSettings
{
  double rate = 5.0; ///< blocks per second (paper: 5 Hz); 0: every map is a block
  Compensation compensation = Compensation::exact;
  /// Eq. 1 asks for 164 ms from rest to 0.5 V and for up to 180 ms for small rises just above it:
  /// more than the paper's "150 ms or less".
  Time max_lead = std::chrono::milliseconds(180);
  /// From Driver::transport_latency(), added within max_lead to every lead of a motor whose own
  /// latency is not known.
  Time transport_latency{ 0 };
  /// From Driver::line(): of transport_latency, what all levels take. A lead has what those take
  /// that change in its block, and there is no block until the line has carried the one before.
  LineTime line{};
  double volts_max = 3.0;         ///< level 1.0
  double volts_min = kStartVolts; ///< commands below are sent as 0
  double intensity = 1.0;         ///< master, [0, 1]
  std::vector<int>
      mapping{}; ///< cell (row-major) → tactor index, −1 for none; empty: cell i is tactor i
  MotorLimits limits{};
  /// Rises from rest begin with a pulse of volts_max that lasts until the motor is at 90 % of its
  /// level, and kShortestKick at least: weak levels start motors that stick, and come in time with
  /// less lead.
  bool kick_start = false;
};

/// Turns the stream of tactile maps into commands. Time is running time, and no clock is looked at;
/// maps come in order of time. Not thread-safe.
///
/// Maps are taken in blocks of 1 / rate: a block begins with the first map of which more than half
/// lies beyond the block's start on a regular grid, and its level is that map's (paper, Section 2:
/// the tactile buffers are read at a lower rate). The grid begins with the first map, and anew
/// after silence(), reset(), a change of rate, mapping or grid or a hole in which a whole block was
/// lost. No block begins while the line has the one before to carry: a chair that is large for its
/// line gets fewer blocks, not late ones.
///
/// Under Compensation::exact a rising command is due at the latest time from which its motor gets
/// to 90 % by the frame, from the amplitude that the motor model predicts for that time: a retarget
/// in the middle of a rise does not start from the last command. Commands for one tactor are never
/// due before their predecessors, whose amplitude they build on.
///
/// MotorLimits hold for the times at which commands are due, whatever comes after:
/// - Each command says until when it may last at most. A cue that ran out is over: its tactor is
///   off until a block in which the film wants nothing of it, or for kLongestRest if the film never
///   lets go of it. Nor does a cue begin that would last less than kShortestCue.
/// - Of more than max_active tactors the strongest are on; of equals those that are. Where a rise
///   comes before the frame at which another tactor ends, that one ends when the rise begins, the
///   weakest first.
/// - reset() begins running time anew, but not the account: time in which nothing was played is not
///   known, so what follows is taken to follow at once.
///
/// Not thread-safe: one thread at a time (tactorsink's streaming thread).
class CommandPlanner
{
public:
  /// A pulse shorter than this does not get a motor off its rest.
  static constexpr Time kShortestKick = std::chrono::milliseconds(10);
  /// What an on-time of 2 s asks for under a duty of 40 %.
  static constexpr Time kLongestRest = std::chrono::seconds(3);
  /// A motor takes up to 180 ms to rise: a shorter cue is not the one that was meant.
  static constexpr Time kShortestCue = std::chrono::milliseconds(200);

  explicit CommandPlanner(int tactors, PlannerSettings settings = {}, RiseTime rise_time = {});
  /// Each tactor with a motor of its own; tactors beyond motors.size() have the paper's.
  CommandPlanner(int tactors, PlannerSettings settings, std::vector<MotorParameters> motors);

  /// New settings apply from the next map on.
  void set_settings(PlannerSettings settings);
  const PlannerSettings &settings() const;

  /// What is wrong with a mapping of that many cells on a board of that many tactors, in one line;
  /// empty if nothing is.
  static std::string validate_mapping(std::span<const int> mapping, int cells, int tactors);

  /// The map (row-major levels in [0, 1]; others are clamped, NaN is 0) whose frame is shown during
  /// [time, time + duration); duration ≤ 0 is taken as 1/30 s. Returns the commands of the block
  /// that begins here, none inside a block or where nothing changes. Where two cells share a tactor
  /// the stronger one counts; cells without a tactor are ignored.
  std::vector<Command> plan(Time time, Time duration, std::span<const float> levels);

  /// Everything to zero at `time` (gap, end of stream). The next map begins a new block.
  std::vector<Command> silence(Time time);

  /// The motors were silenced at `time` and nothing planned to be due later came to pass (no map
  /// came). The next map begins a new block.
  void silenced(Time time);

  /// As silenced(), and running time begins anew (flush).
  void reset(Time time);

  /// Since construction.
  const LimitCounters &limited() const;

private:
  /// What is known of one tactor: what it was told, and what its motor made of it.
  struct Tactor
  {
    MotorModel motor;
    double volts = 0;
    std::size_t index = 0;
    Time due = Time::min();
    Time arrival = Time::min(); ///< of the last command at the motor
    Time until = Time::max();   ///< Command::until of the last command
    MotorUse use{};
    MotorUse::End end{};               ///< of the present stretch
    std::optional<Time> spent_since{}; ///< its cue ran out, and the film still wants it
    bool outdone = false;              ///< the film wants it, but stronger ones are on
  };

  /// What one call plans: the frame, and the commands so far.
  struct Plan
  {
    Time effect;
    Time frame;
    Time line{ 0 }; ///< how long it is taken by the levels that change
    std::vector<Command> commands{};
  };

  /// What the line has to carry of a block.
  struct Carried
  {
    Time begin;
    Time end;
  };

  void forget_blocks();
  bool begins_block(Time time, Time duration);
  Plan begin_plan(Time effect, Time frame);
  std::vector<double> target_volts(std::span<const float> levels) const;

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
  Time kick_time(const Tactor &tactor, Time effect, double volts) const;
  Time due_time(const Tactor &tactor, const Plan &plan, double volts, Time kick) const;
  Time exact_time(const Tactor &tactor, Time earliest, Time effect, double volts) const;

  PlannerSettings settings_;
  std::vector<Tactor> tactors_;
  LimitCounters limited_;
  std::optional<Time> restarts_after_; ///< running time begins anew, after this one
  Time account_begin_ = Time::min();   ///< where the time before the last reset() ends
  std::optional<Time> grid_start_;
  std::optional<Carried> carried_; ///< of the last block; none: it is long ago
  std::size_t cells_ = 0;          ///< of the last map
  double next_block_ = 0;          ///< number of the next block on the grid
};

} // namespace tactor
