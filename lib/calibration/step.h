// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/command_trace.h"

#include <span>
#include <vector>

namespace tactor {

/// A change of a motor's voltage that is long enough to be measured. Times are running times.
struct Step
{
  int tactor = 0;
  double start_volts = 0; ///< held before; 0: at rest
  double target_volts = 0;
  Time rest_begin{ 0 };    ///< all motors are at zero volts from here…
  Time rest_end{ 0 };      ///< …to here, before the step
  Time at{ 0 };            ///< time of the command for the target
  Time effect{ 0 };        ///< time at which the vibration was due
  Time end{ 0 };           ///< end of the target voltage
  Time off{ 0 };           ///< all motors are at zero volts again from here…
  Time next{ 0 };          ///< …to here
  bool overlapped = false; ///< another tactor was on at the same time

  bool rises() const
  {
    return target_volts > start_volts;
  }
};

/// Finds the steps in a command trace, in order of time: each from one held voltage to another, up
/// or down but not to zero. Voltages other than rest are held for at least `hold`. `end`: end of
/// the recording.
std::vector<Step> steps_of(std::span<const IssuedCommand> trace, Time end,
                           Time hold = std::chrono::milliseconds(250));

} // namespace tactor
