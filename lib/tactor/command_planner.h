// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/motor_model.h"
#include "tactor/rise_time.h"
#include "tactor/time.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactor {

/// How a command is moved before the frame it belongs to (paper, Section 4).
enum class Compensation
{
  exact,       ///< issued at T − rise time, not rounded
  frame_block, ///< the paper's: T − rise time rounded up to whole frames, "first three frames old, remaining two new"
  none,        ///< issued at T
};

/// One tactor gets one voltage.
struct Command
{
  Time effect{ 0 }; ///< running time of the frame: when the vibration shall be there
  Time lead{ 0 };   ///< how much earlier the command is issued, ≥ 0
  int tactor = 0;
  double volts = 0;

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
  /// Eq. 1 asks for 164 ms from rest to 0.5 V and for up to 180 ms for small rises just above it: more than the paper's "150 ms or less".
  Time max_lead = std::chrono::milliseconds(180);
  Time transport_latency{
    0
  };                      ///< from Driver::transport_latency(), added to every lead within max_lead
  double volts_max = 3.0; ///< level 1.0
  double volts_min = kStartVolts; ///< commands below are sent as 0
  double intensity = 1.0;         ///< master, [0, 1]
  std::vector<int>
      mapping{}; ///< cell (row-major) → tactor index, −1 for none; empty: cell i is tactor i
};

/// Turns the stream of tactile maps into commands. Time is running time, and no clock is looked at; maps come in order
/// of time. Not thread-safe.
///
/// Maps are taken in blocks of 1 / rate: a block begins with the first map of which more than half lies beyond the
/// block's start on a regular grid, and its level is that map's (paper, Section 2: the tactile buffers are read at a lower
/// rate). The grid begins with the first map, and anew after silence(), reset(), a change of rate, mapping or grid or a hole in
/// which a whole block was lost.
///
/// Under Compensation::exact a rising command is due at the latest time from which its motor gets to 90 % by the frame, from the
/// amplitude that the motor model predicts for that time: a retarget in the middle of a rise does not start from the last
/// command. Commands for one tactor are never due before their predecessors, whose amplitude they build on.
class CommandPlanner
{
public:
  explicit CommandPlanner(int tactors, PlannerSettings settings = {}, RiseTime rise_time = {});

  /// New settings apply from the next map on.
  void set_settings(PlannerSettings settings);
  const PlannerSettings &settings() const;

  /// What is wrong with a mapping of that many cells on a board of that many tactors, in one line; empty if nothing is.
  static std::string validate_mapping(std::span<const int> mapping, int cells, int tactors);

  /// The map (row-major levels in [0, 1]; others are clamped, NaN is 0) whose frame is shown during
  /// [time, time + duration); duration ≤ 0 is taken as 1/30 s. Returns the commands of the block that begins here, none inside a
  /// block or where nothing changes. Where two cells share a tactor the stronger one counts; cells without a tactor are ignored.
  std::vector<Command> plan(Time time, Time duration, std::span<const float> levels);

  /// Everything to zero at `time` (gap, end of stream). The next map begins a new block.
  std::vector<Command> silence(Time time);

  /// Forgets everything (flush, start): motors are at rest, the next map begins a new block.
  void reset();

private:
  /// What is known of one tactor: what it was told, and what its motor made of it.
  struct Tactor
  {
    MotorModel motor;
    double volts = 0;
    Time due = Time::min();
  };

  bool begins_block(Time time, Time duration);
  std::vector<double> target_volts(std::span<const float> levels) const;
  Command command(int tactor, Time effect, Time frame, double volts);
  Time exact_time(const Tactor &tactor, Time earliest, Time effect, double volts) const;
  Time frame_block_time(const Tactor &tactor, Time earliest, Time effect, Time frame,
                        double volts) const;

  PlannerSettings settings_;
  RiseTime rise_time_;
  std::vector<Tactor> tactors_;
  std::optional<Time> grid_start_;
  std::size_t cells_ = 0; ///< of the last map
  double next_block_ = 0; ///< number of the next block on the grid
};

} // namespace tactor
