// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_trace.h"
#include "tactor/time.h"

#include <span>
#include <vector>

namespace tactor {

/// One change of a motor's voltage that is long enough to be measured. Times are running times.
struct Step
{
  int tactor = 0;
  double start_volts = 0; ///< held before; 0: at rest
  double target_volts = 0;
  Time rest_begin{ 0 };    ///< the motors are at zero volts from here…
  Time rest_end{ 0 };      ///< …to here, before the step
  Time at{ 0 };            ///< when the driver was told the target
  Time effect{ 0 };        ///< when the vibration was to be there
  Time end{ 0 };           ///< when the target ends
  Time off{ 0 };           ///< when they are at zero volts again…
  Time next{ 0 };          ///< …and until when
  bool overlapped = false; ///< another tactor was on meanwhile

  bool rises() const
  {
    return target_volts > start_volts;
  }
};

/// The steps in a trace of commands, in order of time: each from a voltage that was held to one
/// that is held, both (rest excepted) for at least `hold`, up or down but not to zero. `end` is
/// when the recording ends.
std::vector<Step> steps_of(std::span<const IssuedCommand> trace, Time end,
                           Time hold = std::chrono::milliseconds(250));

} // namespace tactor
