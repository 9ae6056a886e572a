// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstdint>

namespace synth {

using visuotactile::Time;

/// Samples at regular times, without drift.
struct SampleGrid
{
  Time origin{ 0 }; ///< of sample 0
  int rate = 48000; ///< samples a second

  /// The sample nearest to a time.
  std::int64_t index_of(Time time) const;
  /// The time of a sample, rounded to the next lower nanosecond.
  Time time_of(std::int64_t index) const;
};

} // namespace synth
