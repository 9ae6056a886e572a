// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/line_time.h"
#include "tactor/motor_limits.h"
#include "tactor/rise_time.h"

#include <vector>

namespace tactor {

/// How a command is moved ahead of its frame at T (paper, Section 4).
enum class Compensation
{
  exact, ///< issued at T − rise time, not rounded
  /// The paper's: T − rise time rounded up to whole frames, "first three frames old, remaining two
  /// new".
  frame_block,
  none, ///< issued at T
};

struct PlannerSettings
{
  double rate = 5.0; ///< blocks per second (paper: 5 Hz); 0: every map is a block
  Compensation compensation = Compensation::exact;
  /// Eq. 1 yields 164 ms from rest to 0.5 V and up to 180 ms for small rises just above it, more
  /// than the paper's "150 ms or less".
  Time max_lead = std::chrono::milliseconds(180);
  /// From Driver::transport_latency(). Part of every lead within max_lead, unless the motor's own
  /// latency was measured.
  Time transport_latency{ 0 };
  /// From Driver::line(): the part of transport_latency that depends on how many levels change. A
  /// lead has the time for those of its block. No block begins while the line carries the last one.
  LineTime line{};
  double volts_max = 3.0;         ///< level 1.0
  double volts_min = kStartVolts; ///< commands below are sent as 0
  double intensity = 1.0;         ///< master, [0, 1]
  /// Tactor of each cell (row-major), −1: none. Empty: cell i has tactor i.
  std::vector<int> mapping{};
  MotorLimits limits{};
  /// Rises from rest begin with a pulse of volts_max until the motor is at 90 % of its level, for
  /// 10 ms at least. Weak levels then start motors that stick, and need less lead.
  bool kick_start = false;
};

} // namespace tactor
