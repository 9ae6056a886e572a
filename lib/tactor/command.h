// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

namespace tactor {

/// A voltage for a tactor.
struct Command
{
  Time effect{ 0 }; ///< running time of the frame that it belongs to
  Time lead{ 0 };   ///< how much earlier it is issued, ≥ 0
  int tactor = 0;
  double volts = 0;
  Time until = Time::max(); ///< the motor is off from then on unless another command for it comes
  Time known = Time::min(); ///< when it was handed over to be issued; the planner leaves it

  Time due() const
  {
    return effect - lead;
  }
  bool operator==(const Command &) const = default;
};

} // namespace tactor
