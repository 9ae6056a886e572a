// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/motor_model.h"
#include "tactor/rise_time.h"
#include "tactor/time.h"

#include <optional>
#include <span>
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

  Time
  due() const
  {
    return effect - lead;
  }
  bool operator==(const Command &) const = default;
};

struct PlannerSettings
{
  double rate = 5.0;                        ///< blocks per second (paper: 5 Hz); 0: every map is a block
  Compensation compensation = Compensation::exact;
  Time max_lead = std::chrono::milliseconds(150);
  Time transport_latency{ 0 };              ///< from Driver::transport_latency(), added to every lead within max_lead
  double volts_max = 3.0;                   ///< level 1.0
  double volts_min = kStartVolts;           ///< commands below are sent as 0
  double intensity = 1.0;                   ///< master, [0, 1]
  std::vector<int> mapping;                 ///< cell (row-major) → tactor index, −1 for none; empty: cell i is tactor i
};

/// Turns the stream of tactile maps into commands. Time is running time and never looks at a clock; maps come in
/// order of T. Not thread-safe.
class CommandPlanner
{
public:
  explicit CommandPlanner(int tactors, PlannerSettings settings = {}, RiseTime rise_time = {});

  /// New settings apply from the next map on.
  void set_settings(PlannerSettings settings);
  const PlannerSettings &settings() const;

  /// The map (row-major levels in [0, 1]; others are clamped, NaN is 0) whose frame is shown during
  /// [time, time + duration). Returns the commands of the block that begins here, none inside a block or where nothing
  /// changes: due times of one tactor never decrease.
  std::vector<Command> plan(Time time, Time duration, std::span<const float> levels);

  /// Everything to zero at `time` (gap, end of stream, mute). The next map begins a new block.
  std::vector<Command> silence(Time time);

  /// Forgets everything (flush, start): motors are at rest, the next map begins a new block.
  void reset();

private:
  // …
};

} // namespace tactor
